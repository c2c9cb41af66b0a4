//! The tests of the experiment runner, in one program: linking takes longer than most of them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod declarations;
mod drawn;
mod expectations;
mod graphs;
#[cfg(unix)]
mod hostile_experiments;
mod outside;
mod regimes;
mod runs;
mod seed_halves;
mod trust;
mod workshop;

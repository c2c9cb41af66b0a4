//! The tests of PCM, in one program: linking takes longer than most of them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod bad_input;
mod blocks;
mod brute_force;
mod chance;
mod cliques;
mod graphs;
mod large;
mod pretest;
mod scale;
mod work_limit;

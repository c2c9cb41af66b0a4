//! The tests of tables, figures and pages, in one program: linking takes longer than most of them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod maps;
mod page;
mod regimes;
mod tables;
mod trust;

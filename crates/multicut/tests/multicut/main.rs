//! The tests of the multicut, in one program: linking takes longer than most of them.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skips"
)]

mod bands;
mod exhaustive;
mod fixing;
mod instances;
mod invariance;
mod pairs;
mod program;
mod support;
mod trees;
mod wheels;

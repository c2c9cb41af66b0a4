//! The tests of verification, in one program: linking takes longer than most of them.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skips"
)]

mod bad_input;
mod breaks;
mod clean;
mod drawn;
mod extremes;
mod interruptions;
mod invariance;
mod local_errors;
mod mistakes;
mod scores;
mod straight;
mod trials;
mod verdicts;

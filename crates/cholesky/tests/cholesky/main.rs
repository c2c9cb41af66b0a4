//! Factors, solutions and inverses.
//!
//! One program: both halves instantiate the same factors, which take a while to compile.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

mod factorisation;
mod matrices;
mod mixed;

//! The tests of evaluation, in one program: linking takes longer than most of them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod calibration;
mod ground_truth;
mod relations;
mod scope;

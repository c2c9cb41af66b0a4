//! The tests of labels, in one program: linking takes longer than most of them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod labels;
#[cfg(feature = "cli")]
mod program;
mod relations;

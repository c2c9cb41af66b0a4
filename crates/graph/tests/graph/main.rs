//! The tests of graph files, in one program: linking takes longer than most of them.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod foreign_files;
mod round_trip;
mod schema;

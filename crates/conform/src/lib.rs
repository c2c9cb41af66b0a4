//! Checks any program against the contract of posecut's stages from graph to graph, by running it.
//!
//! - [`sample`]: small graphs with everything that the format allows.
//! - [`program`]: running a command with a time limit.
//! - [`checks`]: the demands, one function for each.
//! - [`report`]: the findings, as text and as JSON.

pub mod checks;
pub mod cli;
pub mod program;
pub mod report;
pub mod sample;

pub use checks::check;
pub use program::Program;
pub use report::{CheckReport, Level, Outcome, Report};

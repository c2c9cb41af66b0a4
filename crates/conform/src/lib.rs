//! Holds any program to the contract of posecut's stages from graph to graph, by running it.
//!
//! - [`sample`]: small graphs with all that the format allows in them.
//! - [`program`]: running a command with a time limit.
//! - [`checks`]: what is demanded, one function a demand.
//! - [`report`]: what came out, as text and as JSON.

pub mod checks;
pub mod program;
pub mod report;
pub mod sample;

pub use checks::check;
pub use program::Program;
pub use report::{CheckReport, Level, Outcome, Report};

//! Everything that most users want with a graph of their own: reads it in any format, finds the wrong landmark edges, optimises
//! the others, and writes the graph back in its own format.
//!
//! - [`command`]: the command line.
//! - [`method`]: how the wrong edges are found, by `posecut-verify` within this program or by other stages as programs.
//! - [`summary`]: what was found, in ten lines.
//! - [`movement`]: how far the poses moved.

mod alternatives;
pub mod command;
mod files;
pub mod method;
pub mod movement;
mod page;
mod report;
mod run;
pub mod summary;

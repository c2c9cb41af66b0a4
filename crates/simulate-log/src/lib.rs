//! Simulates the log of a robot with a planar laser scanner: it drives through the corridors of a building and into its rooms, its wheels
//! slip, and its scanner sees the walls with noise. The true poses are known.
//!
//! - [`plan`]: blocks of rooms with doors, between corridors that form loops.
//! - [`route`]: a walk along the corridors, in and out of rooms.
//! - [`drive`]: the pose at every scan.
//! - [`sensors`]: odometry and ranges.
//! - [`relations`]: true motions between pairs of times, as Kuemmerle et al. (Autonomous Robots 27, 2009) measure by.
//!
//! Lengths are metres, angles radians, times microseconds. A seed means the same log on every machine.

#[cfg(feature = "cli")]
pub mod cli;
pub mod drive;
mod options;
pub mod plan;
pub mod relations;
pub mod route;
pub mod sensors;
mod simulation;

pub use options::{OptionError, Options};
pub use simulation::{Simulated, simulate};

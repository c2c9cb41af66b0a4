//! Simulates pose graphs of which everything is drawn from a seed: the world, the number of robots, how noisy odometry and landmark edges
//! are, how far that is from what their covariances claim, and which landmark edges are incorrect and why. The truth is known.
//!
//! - [`Character`]: everything that is drawn once for a graph. An option fixes a part of it; the others stay as the seed drew them.
//! - `world`: the true paths, in the plane or in space.
//! - `odometry`: what the robots measure of their steps.
//! - `landmarks`: correct edges, and what a recogniser claims.
//! - `mistakes`: incorrect edges of four kinds.
//!
//! Lengths are metres, angles radians; a step of a robot is 1 m long. A seed means the same graph on every run and thread count.

mod character;
#[cfg(feature = "cli")]
pub mod cli;
mod landmarks;
mod mistakes;
mod noise;
mod odometry;
mod options;
mod simulation;
mod world;

pub use character::Character;
pub use mistakes::Mistake;
pub use options::{OptionError, Options};
pub use simulation::{Simulated, simulate};
pub use world::World;

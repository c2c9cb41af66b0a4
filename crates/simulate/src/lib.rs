//! Simulates sessions: a robot drives over a campus for an hour and a half, and its sensors write files as NCLT's do.
//! All sessions share one campus; each has its own route.
//!
//! - [`campus`]: the network of paths, the terrain, and the iron that disturbs a compass.
//! - [`route`]: a walk over the network, with revisits in both directions.
//! - [`drive`]: the pose at every instant: speed, turns, stops.
//! - [`sensors`]: the measurements of each sensor.
//! - [`world`], [`lasers`]: a floor plan, and what laser scanners see of it.
//! - [`session`]: the rows of its files.
//!
//! The program writes the files; without the feature `cli` the crate is the simulation alone.
//!
//! Frames are as in NCLT: x north, y east, z down; yaw clockwise from north.

pub mod campus;
#[cfg(feature = "cli")]
pub mod cli;
pub mod drive;
pub mod lasers;
mod noise;
mod options;
pub mod route;
mod scanners;
pub mod sensors;
pub mod session;
pub mod world;

pub use options::{OptionError, Options};
pub use route::Route;
pub use scanners::Scanners;
pub use session::{Session, SessionFile, Summary, is_session_file, simulate};

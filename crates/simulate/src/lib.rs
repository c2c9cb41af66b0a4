//! Simulated sessions: a robot drives over a campus for an hour and a half, and its sensors write what
//! NCLT's would have written. One campus for all sessions, another route for each.
//!
//! - [`campus`]: the network of paths, the terrain, and what disturbs a compass.
//! - [`route`]: a walk over the network, with revisits in both directions.
//! - [`drive`]: when the robot is where: speed, turns, stops.
//! - [`sensors`]: what each sensor makes of it.
//! - [`session`]: the files.
//!
//! Frames as in NCLT: x north, y east, z down; yaw clockwise from north.

pub mod campus;
pub mod drive;
mod noise;
pub mod route;
pub mod sensors;
pub mod session;

pub use route::Route;
pub use session::{Options, is_session_file, simulate};

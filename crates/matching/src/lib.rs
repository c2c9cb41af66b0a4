//! Registration of planar laser scans: where was the scanner, given what it saw elsewhere?
//!
//! - [`Cloud`]: the points of a scan, or of several scans side by side, with the normals of the walls they lie on.
//! - [`align`]: point-to-line ICP, which refines a pose that is nearly right, with its information matrix.
//! - [`Field`]: correlative matching, which finds a pose in a window of some metres without a start.
//! - [`laser_odometry`]: the motion between successive keyframes, by odometry and scans together.
//! - [`agreement`]: how much of what one cloud sees the other confirms.
//!
//! Everything is deterministic and runs on one thread. Lengths are metres, angles radians. A match is the pose of the *query* in
//! the frame of the *reference*, as the measurement of an edge from the reference's node to the query's.

mod agreement;
mod cloud;
mod correlative;
mod field;
mod icp;
mod information;
pub mod laser_odometry;
mod neighbours;
mod segments;
mod sight;

pub use agreement::{Agreement, agreement};
pub use cloud::{Cloud, OFF_GRID};
pub use correlative::{Found, Window};
pub use field::Field;
pub use icp::{Alignment, IcpOptions, align, robust_deviation};
pub use neighbours::Neighbours;
pub use sight::{Sight, sight};

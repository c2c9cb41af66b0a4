//! Laser scans of keyframes, as records of kind `scan` that travel in a pose graph.
//!
//! ```
//! use posecut_scan::{LaserScan, Scans};
//!
//! let line = r#"{"kind":"scan","node":7,"first_angle":0,"angle_step":1.5707963267948966,"ranges":[2,0,1]}"#;
//! let scans = Scans::read("example", line.as_bytes()).unwrap();
//! let points: Vec<_> = scans.at(7).unwrap().points().collect();
//! assert!((points[1].x + 1.0).abs() < 1e-12, "the beam without a return has no point");
//! ```
//!
//! The [README](https://docs.rs/posecut-scan) describes the fields. Lengths are metres, angles radians.

mod collection;
mod error;
mod laser;
mod records;
mod wall;

pub use collection::Scans;
pub use error::ScanError;
pub use laser::LaserScan;
pub use records::{put_into_graph, write_records};
pub use wall::{Wall, distance_to_wall};

/// The value of `"kind"` in the records of this crate.
pub const KIND: &str = "scan";

//! Occupancy grids (Moravec, Elfes, ICRA 1985; Thrun, Burgard, Fox, *Probabilistic Robotics*, 2005, chapter 9) from the poses and the laser
//! scans of a pose graph.
//!
//! - [`Grid`]: log-odds by cells, updated by the beams of scans.
//! - [`Picture`]: the grid with the trajectories of the sessions, as PNG.
//! - [`write_opacity`]: the grid as the opacity of ink, for pages.
//! - [`ros`]: the grid as a map of ROS, PGM and YAML.
//!
//! Lengths are metres, angles radians. The grid's first row is at the least y.

#[cfg(feature = "cli")]
pub mod cli;
mod error;
mod grid;
mod opacity;
mod picture;
mod rays;
pub mod ros;

pub use error::MapError;
pub use grid::{Cell, Grid};
pub use opacity::write_opacity;
pub use picture::Picture;

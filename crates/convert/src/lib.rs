//! Converts pose graphs and trajectories of other tools to pose-graph JSON Lines and back.
//!
//! - [`g2o`]: `VERTEX_SE2`, `EDGE_SE2`, `VERTEX_SE3:QUAT`, `EDGE_SE3:QUAT`, `FIX`.
//! - [`toro`]: `VERTEX2`, `EDGE2`, `VERTEX3`, `EDGE3`.
//! - [`jrl`]: datasets of several robots with ground truth and labels.
//! - [`tum`]: one pose a line, `seconds x y z qx qy qz qw`.
//! - [`kitti`]: one pose a line, the twelve numbers of a 3x4 matrix.
//! - [`evo`]: the result file of an absolute trajectory error, written only.
//!
//! [`input`] reads and [`output`] writes any of these, as programs do: with options, messages and statistics. [`trajectory`] makes
//! graphs of trajectories, and [`closures`] adds landmark edges from a table.
//!
//! Information matrices are used unchanged, as in gtsam. g2o's own 3-D residual uses the vector part of the quaternion,
//! half the rotation, so its optima differ from ours in the weight of rotations.

#[cfg(feature = "cli")]
pub mod cli;
pub mod closures;
mod error;
pub mod evo;
pub mod format;
pub mod g2o;
mod information;
#[cfg(feature = "cli")]
pub mod input;
#[cfg(feature = "cli")]
mod join;
pub mod jrl;
pub mod kitti;
mod lines;
mod odometry;
#[cfg(feature = "cli")]
pub mod output;
mod printed_digits;
mod record;
pub mod toro;
pub mod trajectory;
mod trajectory_lines;
pub mod tum;

pub use error::ConvertError;
pub use format::FileFormat;
pub use information::Repair;
pub use odometry::{NextIds, Odometry};

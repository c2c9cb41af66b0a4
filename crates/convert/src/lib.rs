//! Converts pose graphs and trajectories of other tools to pose-graph JSON Lines and back.
//!
//! - [`g2o`]: `VERTEX_SE2`, `EDGE_SE2`, `VERTEX_SE3:QUAT`, `EDGE_SE3:QUAT`, `FIX`.
//! - [`toro`]: `VERTEX2`, `EDGE2`, `VERTEX3`, `EDGE3`.
//! - [`tum`]: one pose a line, `seconds x y z qx qy qz qw`.
//! - [`kitti`]: one pose a line, the twelve numbers of a 3x4 matrix.
//! - [`evo`]: the result file of an absolute trajectory error, written only.
//!
//! Information matrices are used unchanged, as in gtsam. g2o's own 3-D residual uses the vector part of the quaternion,
//! half the rotation, so its optima differ from ours in the weight of rotations.

mod error;
pub mod evo;
pub mod format;
pub mod g2o;
mod information;
pub mod kitti;
mod lines;
mod printed_digits;
mod record;
pub mod toro;
mod trajectory_lines;
pub mod tum;

pub use error::ConvertError;
pub use format::FileFormat;
pub use information::Repair;

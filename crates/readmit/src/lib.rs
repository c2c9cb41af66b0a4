//! Re-admission: PCM judges landmark edges by pairs; this stage judges each one by the map that all others make.
//!
//! The optimiser predicts the pose that an edge measures, with a covariance ([`PREDICTED_COVARIANCE`]). The innovation of
//! the edge is the difference between measurement and prediction. A rejected edge with a small innovation is used again; an
//! edge in use with a large innovation is rejected.
//!
//! - `innovation`: the innovation of an edge, from marginals with or without its own measurement.
//! - `by_chance`: how many edges between random positions would have as small an innovation.
//! - [`mod@readmit`]: all edges of a graph, with an estimated scale of their covariances.
//! - `stage`: the program.
//!
//! [`posecut_pcm`] provides the covariances of measurements, the quantiles and the limit on false alarms.

mod by_chance;
#[cfg(feature = "cli")]
pub mod cli;
mod error;
mod innovation;
pub mod readmit;
#[cfg(feature = "cli")]
mod stage;

pub use error::ReadmitError;
pub use readmit::{PREDICTED_COVARIANCE, Readmission, Readmitted, readmit};
#[cfg(feature = "cli")]
pub use stage::Options;

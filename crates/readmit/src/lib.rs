//! Re-admission: PCM judges landmark edges by pairs, and this judges each by the map that all others make.
//!
//! The optimiser predicts the pose that an edge measures, with a covariance ([`PREDICTED_COVARIANCE`]). The innovation of the
//! edge is the difference of both: a rejected edge with a small one is used again, an edge in use with a large one is
//! rejected.
//!
//! - `innovation`: the innovation of an edge, from the marginals that contain it or not.
//! - `by_chance`: how many edges between random positions would have as small an innovation.
//! - [`mod@readmit`]: all edges of a graph, with an estimated scale of their covariances.
//! - `stage`: the program.
//!
//! Covariances of measurements, quantiles and the limit on false alarms are those of [`posecut_pcm`].

mod by_chance;
mod error;
mod innovation;
pub mod readmit;
mod stage;

pub use error::ReadmitError;
pub use readmit::{PREDICTED_COVARIANCE, Readmission, Readmitted, readmit};
pub use stage::Options;

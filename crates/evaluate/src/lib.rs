//! Evaluates an estimate: the error of its poses against a reference, and how many of the landmark edges in use are
//! correct.
//!
//! - [`alignment`]: the rigid motion (or similarity) that brings two sets of points closest (Umeyama 1991).
//! - [`summary`]: the usual statistics of SLAM: rmse, mean, median, std, min, max, sse.
//! - [`trajectory`]: absolute and relative trajectory errors (Sturm et al., IROS 2012).
//! - [`edges`]: precision and recall of the landmark edges in use.
//! - [`ground_truth`]: how far the estimate and its reference are from the truth.
//! - [`relations`]: errors of relative motions that were measured by hand (Kuemmerle et al. 2009).
//! - [`calibration`]: how often the edges of each `verify_probability` are correct.
//! - [`result`]: all of these in one JSON document that names its alignment.

pub mod alignment;
pub mod calibration;
#[cfg(feature = "cli")]
pub mod cli;
pub mod edges;
mod error;
pub mod ground_truth;
pub mod relations;
pub mod result;
pub mod summary;
pub mod trajectory;

pub use error::EvaluateError;
pub use result::{EvaluationResult, Options, Scope, evaluate, evaluate_with_relations};

//! What can be wrong with a change.

use posecut_optimize::ProblemError;
use thiserror::Error;

/// Why a change cannot be made. The solver is as it was before.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum IncrementalError {
    /// A threshold is negative or not finite.
    #[error("the {name} is {value}: it must be zero or a positive number")]
    Threshold {
        /// Which.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A count is zero.
    #[error("the number of {name} is zero: it must be at least 1")]
    Zero {
        /// Which.
        name: &'static str,
    },
    /// A pose or an edge cannot be used as it stands.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The edge was never added.
    #[error("edge {edge} cannot be removed: no edge with this number was ever added")]
    UnknownEdge {
        /// Its number.
        edge: u64,
    },
    /// The edge is no longer there.
    #[error("edge {edge} cannot be removed: it was removed before; add it again first")]
    RemovedEdge {
        /// Its number.
        edge: u64,
    },
}

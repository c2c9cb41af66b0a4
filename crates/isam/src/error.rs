//! Why a change can be refused.

use posecut_optimize::ProblemError;
use thiserror::Error;

/// Why a change was refused. The solver is unchanged.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum IncrementalError {
    /// A threshold is negative or not finite.
    #[error("the {name} is {value}: it must be zero or a positive number")]
    Threshold {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A count is zero.
    #[error("the number of {name} is zero: it must be at least 1")]
    Zero {
        /// Its name.
        name: &'static str,
    },
    /// A pose or an edge is not usable.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The edge was never added.
    #[error("edge {edge} cannot be removed: no edge with this number was ever added")]
    UnknownEdge {
        /// Its number.
        edge: u64,
    },
    /// The edge was removed before.
    #[error("edge {edge} cannot be removed: it was removed before; add it again first")]
    RemovedEdge {
        /// Its number.
        edge: u64,
    },
}

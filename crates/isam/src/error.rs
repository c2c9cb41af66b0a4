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
    /// The edge was absorbed when one of its poses was marginalised.
    #[error(
        "edge {edge} from pose {from} to pose {to} cannot be removed: it is part of the marginalised past; remove an edge before its poses are marginalised, or marginalise later"
    )]
    AbsorbedEdge {
        /// Its number.
        edge: u64,
        /// One of its poses.
        from: usize,
        /// The other one.
        to: usize,
    },
    /// A new edge ends at a marginalised pose.
    #[error(
        "edge {edge} from pose {from} to pose {to} cannot be added: pose {pose} was marginalised; add edges before their poses are marginalised, or keep the pose"
    )]
    MarginalisedPose {
        /// The number that the edge would get.
        edge: u64,
        /// Its first pose.
        from: usize,
        /// Its second pose.
        to: usize,
        /// The one that was marginalised.
        pose: usize,
    },
    /// The pose to marginalise does not exist.
    #[error("pose {pose} cannot be marginalised: there are only {poses} poses")]
    UnknownPose {
        /// Its number.
        pose: usize,
        /// Number of poses.
        poses: usize,
    },
    /// The pose was marginalised before.
    #[error("pose {pose} cannot be marginalised: it was marginalised before")]
    MarginalisedTwice {
        /// Its number.
        pose: usize,
    },
    /// The pose to marginalise is a constant.
    #[error(
        "pose {pose} cannot be marginalised: it is {}; leave it out, a fixed pose is a constant and costs nothing",
        if *held { "held" } else { "the gauge that gives its component a position" }
    )]
    FixedPose {
        /// Its number.
        pose: usize,
        /// Whether it is held for good. Otherwise it is the gauge of its component.
        held: bool,
    },
}

//! Errors of re-admission.

use posecut_pcm::PcmError;

/// A graph or option that re-admission cannot use.
#[derive(Debug, thiserror::Error)]
pub enum ReadmitError {
    /// A covariance, a probability or a cost that PCM cannot use either.
    #[error(transparent)]
    Pcm(#[from] PcmError),
    /// A landmark edge without a usable `predicted_covariance`.
    #[error(
        "{edge}: its field predicted_covariance {reason}; re-admission needs the optimiser's marginals, as posecut-optimize --marginals landmark writes them"
    )]
    Prediction {
        /// The edge.
        edge: String,
        /// What is wrong with the field.
        reason: String,
    },
    /// A node without an estimate.
    #[error(
        "node {node}: it has no pose; re-admission needs an optimised graph, as posecut-optimize --marginals landmark writes it"
    )]
    Pose {
        /// The node.
        node: u64,
    },
}

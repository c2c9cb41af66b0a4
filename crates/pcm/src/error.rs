//! What PCM cannot work with.

/// A graph or option that PCM refuses.
#[derive(Debug, thiserror::Error)]
pub enum PcmError {
    /// An edge whose information matrix has no inverse.
    #[error(
        "{edge}: its information matrix has no inverse ({reason}), so its covariance is unknown; give every edge a positive definite information matrix, or leave the measurement of a landmark edge out"
    )]
    Covariance {
        /// The edge.
        edge: String,
        /// What the factorisation met.
        reason: String,
    },
    /// A probability outside (0, 1).
    #[error("--probability is {value}, and must lie between 0 and 1, both excluded")]
    Probability {
        /// What was given.
        value: f64,
    },
}

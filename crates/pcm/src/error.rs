//! Errors of PCM.

/// A graph or option that PCM cannot use.
#[derive(Debug, thiserror::Error)]
pub enum PcmError {
    /// An edge whose information matrix has no inverse.
    #[error(
        "{edge}: its information matrix has no inverse ({reason}), so its covariance is unknown; give every edge a positive definite information matrix, or leave the measurement of a landmark edge out"
    )]
    Covariance {
        /// The edge.
        edge: String,
        /// What the factorisation found.
        reason: String,
    },
    /// A probability outside (0, 1).
    #[error(
        "a probability is {value}, but must be greater than 0 and less than 1; --help shows the options that take one with the value P"
    )]
    Probability {
        /// The given value.
        value: f64,
    },
    /// A length, an angle, a scale or a limit that is not a positive number.
    #[error("{option} is {value}, but must be a positive number")]
    NotPositive {
        /// The option.
        option: &'static str,
        /// The given value.
        value: f64,
    },
    /// An option that has no effect on a test without covariances.
    #[error(
        "{option} has no effect with --test threshold, which reads no covariances; leave out one of the two"
    )]
    CovariancesUnread {
        /// The option.
        option: &'static str,
    },
    /// The consistency graph of a group is requested, but it is not computed.
    #[error(
        "--consistency-graph needs the tests of all pairs, but a group of {candidates} candidates is solved by cells, without these tests; add --scheme exact, which takes {megabytes} MB for this group"
    )]
    GraphNotMade {
        /// Candidates of the group.
        candidates: usize,
        /// Memory of its bit matrix.
        megabytes: usize,
    },
}

//! Doubts: reasons to check a result before trusting it.
//!
//! A stage raises a doubt ([`Context::doubt`]) when it has done its work but has a reason to mistrust the result. A doubt is
//! printed as a warning on standard error, even with `--quiet`. Its name appears under `doubts` in `--stats` and in the stage's
//! entry of the provenance. With `--strict`, the exit status is 3.

use std::fmt;

use tracing::warn;

use crate::Context;

/// The exit status with `--strict` if the program did its work but raised a doubt.
pub(crate) const STATUS: u8 = 3;

/// The target of the warnings about doubts. `--quiet` does not silence it.
pub(crate) const TARGET: &str = "posecut::doubt";

/// A reason to mistrust a result. The set is closed; docs/doubts.md explains it to users.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Doubt {
    /// An iteration ended before a tolerance was met, so the poses are not a minimum of the cost. Raise the limit of iterations,
    /// start elsewhere, or check the information matrices.
    NotConverged,
    /// The squared residuals overflow. Only a robust cost is finite, because it bounds the contribution of each edge.
    /// Reject the edge with the gross measurement, or give it moderate values. A result without any finite cost is an error.
    NonFiniteCost,
    /// The edges in use leave a component of a pose undetermined, and the result keeps it near its start. Give the edges
    /// information in every direction, or add edges.
    Undetermined,
    /// A certificate of the global minimum was requested but not found, or a point of lower cost is known. Start elsewhere
    /// (`--initialisation`), or check the landmark edges.
    NotCertified,
    /// The search reached its work or time limit, or its method proves nothing, so a better result may exist. Raise the limit
    /// or choose the exact method.
    SearchLimit,
    /// There were candidates, but none was kept. Check units and covariances, and whether the sessions overlap at all.
    NothingKept,
    /// A multicut cut every landmark edge. Check the costs, or `--delta`.
    EverythingCut,
    /// Most landmark edges are cut only because no other landmark edge is within `--delta`. That is no evidence against them.
    /// Set `--delta` to the spacing of the candidates.
    NoSupportWithinDelta,
    /// The landmark edges do not determine the scale of the covariances. The covariances are used unchanged, or scaled as far
    /// as the bounds of the estimate allow. Check the covariances, or give their scale.
    CalibrationOnPrior,
    /// Covariances were invented or repaired, because the source had none or had impossible ones. Give the sensor's own.
    CovarianceInvented,
    /// The graph is not connected, so the relative poses of its components mean nothing. Add or re-admit edges between the
    /// components, or look at each component by itself.
    PartsNotConnected,
}

impl Doubt {
    /// All doubts, in the order in which lists show them.
    pub const ALL: [Self; 11] = [
        Self::NotConverged,
        Self::NonFiniteCost,
        Self::Undetermined,
        Self::NotCertified,
        Self::SearchLimit,
        Self::NothingKept,
        Self::EverythingCut,
        Self::NoSupportWithinDelta,
        Self::CalibrationOnPrior,
        Self::CovarianceInvented,
        Self::PartsNotConnected,
    ];

    /// The name in `--stats`, in the provenance and in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::NotConverged => "not-converged",
            Self::NonFiniteCost => "non-finite-cost",
            Self::Undetermined => "undetermined",
            Self::NotCertified => "not-certified",
            Self::SearchLimit => "search-limit",
            Self::NothingKept => "nothing-kept",
            Self::EverythingCut => "everything-cut",
            Self::NoSupportWithinDelta => "no-support-within-delta",
            Self::CalibrationOnPrior => "calibration-on-prior",
            Self::CovarianceInvented => "covariance-invented",
            Self::PartsNotConnected => "parts-not-connected",
        }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl Context {
    /// Raises a doubt about the result. Call it before the result is written. The message is one sentence with numbers and what
    /// to do; it is shown even with `--quiet`.
    pub fn doubt(&mut self, doubt: Doubt, message: impl fmt::Display) {
        warn!(target: TARGET, "{message}");
        self.doubt_messages.push((doubt, message.to_string()));
        self.also_doubt(doubt);
    }

    /// Raises a doubt without a message, because the message of another doubt already explains it.
    pub fn also_doubt(&mut self, doubt: Doubt) {
        self.doubts.insert(doubt);
    }

    /// The names of the doubts raised so far, each once, in the order of [`Doubt::ALL`].
    pub fn doubts(&self) -> Vec<&'static str> {
        self.doubts.iter().map(|doubt| doubt.name()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_doubts_are_listed_in_order_and_have_names_of_their_own() {
        assert!(Doubt::ALL.windows(2).all(|pair| pair[0] < pair[1]));
        let names: std::collections::BTreeSet<&str> = Doubt::ALL.iter().map(|doubt| doubt.name()).collect();
        assert_eq!(names.len(), Doubt::ALL.len());
        let is_kebab = |name: &&str| name.chars().all(|letter| letter.is_ascii_lowercase() || letter == '-');
        assert!(names.iter().all(is_kebab), "{names:?}");
    }
}

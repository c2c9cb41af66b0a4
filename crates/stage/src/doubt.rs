//! Results that should not be believed without a look.
//!
//! A stage that did its work, and knows of a reason to mistrust what came out, raises a doubt ([`Context::doubt`]): a warning on
//! standard error, also with `--quiet`; a name under `doubts` in `--stats` and in the stage's entry of the provenance; with
//! `--strict`, exit status 3.

use std::fmt;

use tracing::warn;

use crate::Context;

/// The exit status of a program that did its work and doubts the result, with `--strict`.
pub(crate) const STATUS: u8 = 3;

/// The target of the warnings about doubts. `--quiet` does not silence it.
pub(crate) const TARGET: &str = "posecut::doubt";

/// A reason to mistrust a result. The set is closed; docs/doubts.md explains it to users.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Doubt {
    /// An iteration ended before a tolerance was met, so the poses are not a minimum of the cost. Raise the limit of iterations,
    /// start elsewhere, or check the information matrices.
    NotConverged,
    /// The squared residuals are beyond the range of numbers; only a robust cost, which bounds what one edge counts, is finite.
    /// Reject the edge with the gross measurement, or give it moderate values. A result without any finite cost is an error.
    NonFiniteCost,
    /// The edges in use leave a component of a pose undetermined, and the result keeps it near its start. Give the edges
    /// information in every direction, or add edges.
    Undetermined,
    /// A certificate of the global minimum was asked for and not found, or a point of lower cost is known. Start elsewhere
    /// (`--initialisation`), or check the landmark edges.
    NotCertified,
    /// A limit of work or time, or a method that proves nothing, ended a search: a better result may exist. Raise the limit or
    /// choose the exact method.
    SearchLimit,
    /// There were candidates, and none is kept. Check units and covariances, and whether there is overlap at all.
    NothingKept,
    /// A multicut cut every landmark edge. Check the costs, or `--delta`.
    EverythingCut,
    /// Most landmark edges are cut only because no other one is within `--delta`, which is no evidence against them. Set
    /// `--delta` to the spacing of the candidates.
    NoSupportWithinDelta,
    /// The landmark edges say too little to estimate the scale of the covariances: they are used as claimed, or as far as the
    /// bounds of the estimate allow. Check the covariances, or give their scale.
    CalibrationOnPrior,
    /// Covariances were made up or repaired, because the source had none or none that is possible. Give the sensor's own.
    CovarianceInvented,
    /// Nothing joins some components of the graph, so their relative poses mean nothing. Add or re-admit edges between them, or
    /// look at each component by itself.
    PartsNotConnected,
}

impl Doubt {
    /// All doubts, in the order of lists.
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
    /// Raises a doubt about the result, before the result is written. The message is one sentence with numbers and what to do;
    /// it is shown with `--quiet`, too.
    pub fn doubt(&mut self, doubt: Doubt, message: impl fmt::Display) {
        warn!(target: TARGET, "{message}");
        self.also_doubt(doubt);
    }

    /// Raises a doubt that the message of another one explains already.
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

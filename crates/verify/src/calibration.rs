//! How far covariances are wrong, for each chain, and what follows for loops and candidates.

use nalgebra::SMatrix;
use serde::Serialize;

use crate::ascent::{EXCEPTION, LANDMARK_LEAST, Point};
use crate::evidence::{Evidence, compare};
use crate::model::Loop;

/// Factors on covariances.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// For each chain, the factor on the covariance of its odometry.
    pub odometry: Vec<f64>,
    /// For each chain, the variance of a coherent error, as the square of a share of the distance travelled.
    pub coherent: Vec<f64>,
    /// The factor on the covariance of landmark edges.
    pub landmark: f64,
    /// Estimated share of correct candidates.
    pub correct: f64,
    /// Counted ratio of local errors (a landmark edge is wrong by up to thirty standard deviations) to correct loops.
    pub local: f64,
    /// Evidence of the loops above that of shuffled ones, nats.
    pub evidence: f64,
    /// Whether the evidence was too little for an estimate, so that covariances are used as claimed.
    pub on_prior: bool,
    /// What is assumed of local errors.
    #[serde(skip)]
    pub(crate) errors: LocalErrors,
    /// A further factor on the covariance of odometry for loops through neighbours of one chain.
    #[serde(skip)]
    pub(crate) short: f64,
    /// Degrees of freedom of the t distribution of errors.
    #[serde(skip)]
    pub(crate) tail: f64,
}

/// Local errors: landmark edges between the right places, measured wrongly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LocalErrors {
    /// They are few, and as wide as `EXCEPTION` says. A narrower or more frequent local error would explain gross errors of odometry, and
    /// make all other noise small.
    Exceptions,
    /// They may outnumber the correct edges. Their variances are these factors on the claimed ones of the translation with the right heading,
    /// and of the rest.
    Common { translation: f64, turning: f64 },
}

/// The smallest ratio of the variance of a local error that is common to that of noise: a narrower one is noise.
const NARROWEST_TO_NOISE: f64 = 25.0;

impl Calibration {
    /// Whether the factor of landmark edges is the smallest one allowed: the loops may ask for a smaller one.
    pub fn is_landmark_least(&self) -> bool {
        // exp(ln(x)) differs from x by rounding.
        self.landmark <= LANDMARK_LEAST * (1.0 + 1e-9)
    }

    /// The factors that turn the claimed covariance of a loop's landmark edges into that of a local error: for translation with the right
    /// heading, and for the rest.
    pub(crate) fn local_factors(&self) -> [f64; 2] {
        match self.errors {
            LocalErrors::Exceptions => [self.landmark.max(1.0) * EXCEPTION; 2],
            LocalErrors::Common { translation, turning } => {
                [translation.max(self.landmark * NARROWEST_TO_NOISE), turning.max(self.landmark)]
            }
        }
    }

    /// The covariance of a local error of a loop's landmark edges, from their covariance and the part of it that is translation with the right
    /// heading.
    pub(crate) fn local<const DOF: usize>(
        &self,
        landmark: &SMatrix<f64, DOF, DOF>,
        translation: &SMatrix<f64, DOF, DOF>,
    ) -> SMatrix<f64, DOF, DOF> {
        let [by_translation, by_turning] = self.local_factors();
        landmark * by_turning + translation * (by_translation - by_turning)
    }

    pub(crate) fn covariance<const DOF: usize>(&self, closed: &Loop<DOF>) -> SMatrix<f64, DOF, DOF> {
        let mut sum = closed.landmark * self.landmark;
        for (chain, random, coherent) in &closed.odometry {
            sum += random * self.odometry[*chain] + coherent * self.coherent[*chain];
        }
        sum
    }

    /// The evidence of a loop; `None` where its covariance is not positive definite.
    pub(crate) fn evidence<const DOF: usize>(&self, closed: &Loop<DOF>) -> Option<Evidence> {
        let local = self.local(&closed.landmark, &closed.translation);
        compare(&closed.error, &self.covariance(closed), &closed.apart, &local, self.tail)
    }

    /// The same calibration with these factors for all chains.
    pub(crate) fn with(&self, point: Point) -> Self {
        let chains = self.odometry.len();
        Self {
            odometry: vec![point.odometry.exp(); chains],
            coherent: vec![point.coherent.exp(); chains],
            landmark: point.landmark.exp(),
            short: point.short.exp(),
            errors: match self.errors {
                LocalErrors::Exceptions => LocalErrors::Exceptions,
                LocalErrors::Common { .. } => LocalErrors::Common {
                    translation: point.local.exp(),
                    turning: (point.local + point.turning).exp(),
                },
            },
            ..*self
        }
    }

    /// The same calibration for loops through neighbours of one chain.
    pub(crate) fn over_short(&self) -> Self {
        Self { odometry: self.odometry.iter().map(|factor| factor * self.short).collect(), ..self.clone() }
    }

    pub(crate) fn of_parts(&self, whole: &[usize]) -> Self {
        let part = |factors: &[f64]| whole.iter().map(|&chain| factors[chain]).collect();
        Self { odometry: part(&self.odometry), coherent: part(&self.coherent), ..*self }
    }

    /// Odds of a local error against a correct closure, from the log-likelihood ratio of a correct closure against a local error.
    pub(crate) fn wrong(&self, against_local: f64) -> f64 {
        self.local * (-against_local).exp()
    }

    /// Prior odds that a candidate is correct.
    pub(crate) fn odds(&self) -> f64 {
        self.correct / (1.0 - self.correct)
    }
}

/// Factor on the prior odds of a candidate that neither the map nor another candidate can judge. Correct candidates mostly
/// have company: one among all accepted candidates is assumed to be alone, compared with the share of unjudged ones among the
/// others.
pub(crate) fn alone(ratio: &[Option<f64>], accepted: &[bool]) -> f64 {
    let silent = ratio.iter().zip(accepted).filter(|(ratio, accepted)| ratio.is_none() && !**accepted);
    let silent = silent.count() as f64;
    let agreed = accepted.iter().filter(|accepted| **accepted).count() as f64;
    let others = accepted.len() as f64 - agreed;
    (others + 1.0) / (silent + 1.0) / (agreed + 1.0)
}

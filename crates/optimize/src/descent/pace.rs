//! Whether a descent creeps.
//!
//! Where residuals are large, their curvature may cancel most of the Gauss-Newton matrix in some direction. Steps are much too short there, and
//! each promises nearly as much as the one before it. Newton's are not, within the region in which its model holds.

use super::outcome::Step;

/// An undamped step of a descent that creeps promises more than this share of the step before it.
const SLOW: f64 = 0.5;
/// The first radius in which Newton's model is trusted, in Gauss-Newton steps.
const FIRST_RADIUS: f64 = 4.0;
/// Shares of its promise that Newton's step keeps: below the first the radius shrinks, above the second it grows.
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;

/// The promise of the last Gauss-Newton step and, once the descent creeps, the radius in which Newton's model is trusted, in the norm of
/// the Gauss-Newton matrix.
pub(super) struct Pace {
    promised: f64,
    radius: Option<f64>,
}

impl Pace {
    pub(super) fn new() -> Self {
        Self { promised: f64::INFINITY, radius: None }
    }

    /// The radius if the descent creeps.
    pub(super) fn radius(&self) -> Option<f64> {
        self.radius
    }

    /// Notes a Gauss-Newton step. Only one that `may_tell`, undamped and late enough, shows that the descent creeps.
    pub(super) fn note(&mut self, step: &Step, may_tell: bool) {
        if self.radius.is_none() && may_tell && step.promised > SLOW * self.promised {
            self.radius = Some(FIRST_RADIUS * step.promised.sqrt());
        }
        self.promised = step.promised;
    }

    /// Adapts the radius to the share of its promise that Newton's step kept; NaN if there was none.
    pub(super) fn adapt(&mut self, gain: f64) {
        if let Some(radius) = &mut self.radius {
            if !(gain >= POOR) {
                *radius *= 0.25;
            } else if gain > GOOD {
                *radius *= 2.0;
            }
        }
    }
}

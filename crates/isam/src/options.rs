//! What the caller may choose.

use posecut_optimize::model::translations;

use crate::IncrementalError;

/// Settings of [`IncrementalSolver`](crate::IncrementalSolver).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IncrementalOptions {
    /// A variable is relinearised when a component of the translation of its linear update exceeds this, metres.
    pub relinearise_translation: f64,
    /// The same for components of the rotation, radians.
    pub relinearise_rotation: f64,
    /// Relinearisation is considered in every so many updates.
    pub relinearise_every: usize,
    /// A subtree is solved again when a component of the linear update of a variable on its separator has changed by more
    /// than this since the last time (metres, radians). Zero solves wherever something changed at all.
    pub propagate: f64,
    /// The share of the cost that linearisation errors may amount to, as the sum of squared differences between residuals and
    /// linear models over the edges at variables beyond the thresholds. Once they amount to more, all these variables
    /// are relinearised. Zero relinearises every such variable at once, as iSAM2 does. The gap to the optimum grows with
    /// it, but it is no bound of the gap: derivatives are stale, too, and a chain of poses amplifies what is out of balance at
    /// one of them.
    pub linearisation_error: f64,
    /// Most linear solutions in one update: above 1, relinearisation and solution are repeated while variables exceed
    /// the thresholds.
    pub iterations: usize,
}

impl Default for IncrementalOptions {
    /// Relinearisation beyond 0.05 m or 0.01 rad, considered in every update, once linearisation errors
    /// amount to 1e-5 of the cost; propagation of changes beyond 1e-4; two solutions.
    fn default() -> Self {
        Self {
            relinearise_translation: 0.05,
            relinearise_rotation: 0.01,
            relinearise_every: 1,
            propagate: 1e-4,
            linearisation_error: 1e-5,
            iterations: 2,
        }
    }
}

impl IncrementalOptions {
    /// Refuses what makes no sense.
    pub(crate) fn check(&self) -> Result<(), IncrementalError> {
        for (name, value) in [
            ("translation threshold of relinearisation", self.relinearise_translation),
            ("rotation threshold of relinearisation", self.relinearise_rotation),
            ("threshold of propagation", self.propagate),
            ("linearisation error", self.linearisation_error),
        ] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(IncrementalError::Threshold { name, value });
            }
        }
        for (name, value) in [
            ("updates from one relinearisation to the next", self.relinearise_every),
            ("linear solutions in an update", self.iterations),
        ] {
            if value == 0 {
                return Err(IncrementalError::Zero { name });
            }
        }
        Ok(())
    }

    /// Threshold for a component of a tangent vector of so many degrees of freedom: translations come first.
    pub(crate) fn relinearise(&self, component: usize, degrees_of_freedom: usize) -> f64 {
        if component < translations(degrees_of_freedom) {
            self.relinearise_translation
        } else {
            self.relinearise_rotation
        }
    }
}

//! The options of the solver.

use posecut_geometry::translations;

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
    /// A subtree is solved again when the linear update of a variable on its separator has changed in a component by more
    /// than this since the last time (metres, radians). Zero means any change.
    pub propagate: f64,
    /// Limit of the linearisation errors as a share of the cost: the sum of squared differences between residuals and linear
    /// models, over the edges at variables beyond the thresholds. Above the limit, all these variables are relinearised. Zero
    /// relinearises each of them at once, as iSAM2 does. A larger limit means a larger gap to the optimum, but the limit is
    /// no bound of this gap: derivatives are out of date, too, and a chain of poses amplifies an imbalance at one of them.
    pub linearisation_error: f64,
    /// Maximum number of linear solutions in one update. Above 1, relinearisation and solution are repeated while variables
    /// exceed the thresholds.
    pub iterations: usize,
    /// Bounds memory and time per update: at the end of an update, poses that are older than the newest so many are
    /// [marginalised](crate::IncrementalSolver::marginalise), in blocks of a tenth of this number. Fixed poses stay: they are
    /// constants. `None` keeps all poses as variables.
    pub lag: Option<usize>,
    /// With a lag: keep every pose whose number is a multiple of this as a variable, so that edges can still reach it.
    pub keep_every: Option<usize>,
    /// With a lag: keep the poses that have a landmark edge when the lag passes them. The others have odometry edges only, so
    /// that each prior joins two poses, as an edge does, and nothing fills in.
    pub keep_landmark_poses: bool,
}

impl Default for IncrementalOptions {
    /// Relinearisation beyond 0.05 m or 0.01 rad, checked in every update, once linearisation errors exceed 1e-5 of the cost;
    /// propagation of changes beyond 1e-4; two solutions; no lag.
    fn default() -> Self {
        Self {
            relinearise_translation: 0.05,
            relinearise_rotation: 0.01,
            relinearise_every: 1,
            propagate: 1e-4,
            linearisation_error: 1e-5,
            iterations: 2,
            lag: None,
            keep_every: None,
            keep_landmark_poses: false,
        }
    }
}

impl IncrementalOptions {
    /// Checks that thresholds are finite and not negative, and that counts are positive.
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
            ("poses in the lag", self.lag.unwrap_or(1)),
            ("poses from one keyframe to the next", self.keep_every.unwrap_or(1)),
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

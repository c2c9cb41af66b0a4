//! Gauss-Newton steps without a factorisation: conjugate gradients on the new matrix, with an older factor as the preconditioner.
//!
//! Far from the minimum, directions in which the old matrix was soft turn stiff, and conjugate gradients need many iterations. Once
//! a step with the old factor promises little, a few suffice (an inexact Newton method: R. S. Dembo, S. C. Eisenstat, T. Steihaug,
//! "Inexact Newton methods", 1982). A factorisation of a large graph takes as long as ten or more of them. Every step has
//! the exact gradient, and tolerances apply to its decrease and the estimate of what it leaves together.

use posecut_cholesky::{End, Symbolic};

use super::outcome::Step;
use super::phases::timed;
use super::workspace::Workspace;
use crate::model::lanes::LaneGroup;

/// The iterations end when they leave less than this share of the model's decrease.
const LEFT: f64 = 1e-3;
/// The iterations also end when the decrease is below this share of what the caller calls enough. The estimate of what they leave is too
/// low in directions in which the old matrix was stiffer.
const SAFETY: f64 = 0.5;
/// Operations of a factorisation in the time that both triangular solves take for an entry of the factor, as measured on spheres of
/// 10^5 and more poses.
const OPERATIONS_PER_ENTRY: f64 = 70.0;
/// The share of a factorisation's time that the iterations may take before they give up.
const SHARE: f64 = 0.5;
/// With fewer iterations than this, a new factor is at least as fast.
const FEWEST: usize = 8;

/// How many iterations a step may take before it gives up; none for a graph whose new factor is at least as fast.
pub(super) fn iterations<const DOF: usize>(symbolic: &Symbolic) -> usize {
    let entries = (symbolic.factor_blocks() * DOF * DOF) as f64;
    let most = (SHARE * symbolic.flops() / (OPERATIONS_PER_ENTRY * entries)) as usize;
    if most < FEWEST { 0 } else { most }
}

impl<G: LaneGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// The undamped step for the equations' matrix with the factor of an earlier one; `None`, with no step, if it would take too many
    /// iterations. A decrease of `enough` ends them.
    pub(super) fn conjugate_step(&mut self, enough: f64) -> Option<Step> {
        if !std::mem::take(&mut self.is_near) || self.conjugate_iterations == 0 {
            return None;
        }
        self.oppose_gradient();
        let end = End { iterations: self.conjugate_iterations, left: LEFT, enough: SAFETY * enough };
        let Self { factor, equations, pattern, step, phases, .. } = self;
        let matrix = equations.damped((0.0, [0.0; DOF]));
        let left = timed(&mut phases.substitution, || {
            factor.iterate(&pattern.symbolic, &pattern.pairs, matrix, step, end)
        })?;
        let mut step = self.full_step()?;
        step.promised += left;
        Some(step)
    }
}

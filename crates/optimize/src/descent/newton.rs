//! Newton's step, by conjugate gradients on the exact second derivative.
//!
//! The damped Gauss-Newton factor is the preconditioner, so the first direction is the Gauss-Newton step, with its exact length, and few
//! more are needed where the residuals curve little. Iteration ends at a direction of negative curvature: before it
//! (R. S. Dembo, T. Steihaug, "Truncated-Newton algorithms for large-scale unconstrained optimization", 1983) or, within a region
//! in which the model is trusted, at the boundary along it ([`truncation`](super::truncation)). The factor stays positive
//! definite where the exact matrix is not, and no matrix is factorised for it.

use nalgebra::SVector;
use posecut_cholesky::vectors::{add, dot};
use posecut_geometry::translations;

use super::outcome::Step;
use super::phases::timed;
use super::truncation::Lengths;
use super::workspace::Workspace;
use crate::model::lanes::LaneGroup;
use crate::model::term::Term;
use crate::normal_equations::NormalEquations;

/// Maximum number of directions.
const DIRECTIONS: usize = 20;
/// The iteration ends when the residual, in the norm of the preconditioner, falls below this share of the gradient's square.
const REDUCTION: f64 = 1e-2;

impl<G: LaneGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Replaces the step by Newton's, damped as the factor is, up to a radius in the norm of the damped Gauss-Newton matrix. `self.step` is the
    /// Gauss-Newton step at these poses, and the gradient belongs to them. `None` if the curvature is negative along the Gauss-Newton step and
    /// the radius infinite; the step then stays the same.
    pub(super) fn newton_step<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        damping: f64,
        radius: f64,
    ) -> Option<Step> {
        let mut exact = self.exact.take().unwrap_or_else(|| NormalEquations::new(self.pattern));
        let Self { pattern, phases, priors, .. } = &mut *self;
        timed(&mut phases.linearisation, || {
            let cost = exact.assemble_exactly(pattern, terms, poses);
            exact.add_priors(pattern.held, priors, poses, cost)
        });
        let scale = self.damping_scale();
        for (block, scale) in exact.diagonal.iter_mut().zip(&scale) {
            for axis in 0..DOF {
                block[(axis, axis)] += damping * scale[axis];
            }
        }
        let found = self.conjugate_gradients(&exact, radius);
        let step = found.map(|solution| {
            let product = exact.times(self.pattern, &solution);
            let damped: f64 = solution
                .iter()
                .zip(&scale)
                .map(|(block, scale)| damping * block.component_mul(block).dot(scale))
                .sum();
            let promised = damped - 2.0 * dot(&solution, &self.equations.gradient) - dot(&solution, &product);
            let size = |block: &SVector<f64, DOF>| self.magnitude.largest(block.iter(), translations(DOF));
            let largest = solution.iter().map(size).fold(0.0, f64::max);
            self.step = solution;
            Step { promised, largest }
        });
        self.exact = Some(exact);
        step.filter(|step| step.promised.is_finite() && step.promised > 0.0)
    }

    /// Minimises `2 g^T d + d^T H d` from zero.
    fn conjugate_gradients(
        &mut self,
        exact: &NormalEquations<DOF>,
        radius: f64,
    ) -> Option<Vec<SVector<f64, DOF>>> {
        let mut solution = vec![SVector::<f64, DOF>::zeros(); self.step.len()];
        let gauss_newton = self.step.clone();
        let mut residual: Vec<_> = self.equations.gradient.iter().map(|gradient| -gradient).collect();
        let mut direction = gauss_newton.clone();
        let mut decrease = dot(&residual, &direction);
        let enough = REDUCTION * decrease;
        let mut lengths = Lengths::new(decrease, radius);
        for count in 0..DIRECTIONS {
            let product = exact.times(self.pattern, &direction);
            let curvature = dot(&direction, &product);
            let length = decrease / curvature;
            if let Some(length) = lengths.boundary(length, curvature) {
                if radius.is_infinite() {
                    self.step = gauss_newton;
                    return (count > 0).then_some(solution);
                }
                add(&mut solution, length, &direction);
                break;
            }
            add(&mut solution, length, &direction);
            add(&mut residual, -length, &product);
            self.step.copy_from_slice(&residual);
            let Self { factor, pattern, step, phases, .. } = self;
            timed(&mut phases.substitution, || factor.precondition(&pattern.symbolic, step));
            let next = dot(&residual, &self.step);
            if !(next > enough) {
                break;
            }
            for (direction, step) in direction.iter_mut().zip(&self.step) {
                *direction = step + *direction * (next / decrease);
            }
            lengths.turn(length, next, next / decrease);
            decrease = next;
        }
        Some(solution)
    }
}

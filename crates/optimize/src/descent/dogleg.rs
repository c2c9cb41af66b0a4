//! Powell's dogleg: a step on the way from steepest descent to Gauss-Newton, as long as the model is trusted.
//!
//! M. J. D. Powell, "A hybrid method for nonlinear equations", 1970; K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear
//! least squares problems", 2004, section 3.3. Lengths are measured in the norm of `diag(H)`, which knows no units.

use nalgebra::SVector;
use posecut_geometry::LieGroup;

use super::damping::{FIRST_DAMPING, LARGEST_DAMPING};
use super::outcome::{Outcome, Termination};
use super::workspace::{Workspace, rounding};
use crate::model::residual::Term;
use crate::options::Options;

/// Share of its promise below which a step halves the radius, and above which it may grow.
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;
/// Below this the radius is rounding, where 1 is a step of the graph's length and a radian in every pose.
const SMALLEST_RADIUS: f64 = 1e-14;

type Steps<const DOF: usize> = Vec<SVector<f64, DOF>>;

impl<G: LieGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Minimises the cost of the edges over all poses but those that are held. A step that fails costs no factorisation.
    pub(crate) fn minimise_by_dogleg<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
    ) -> Outcome {
        let mut outcome = Outcome::new(self.assemble(edges, poses));
        let mut radius = f64::INFINITY;
        let smallest_radius = SMALLEST_RADIUS * self.magnitude.cost.sqrt();
        let mut damping = 0.0;
        while outcome.iterations < options.max_iterations {
            outcome.gradient = self.cosine(outcome.cost);
            if outcome.gradient <= options.gradient_tolerance {
                outcome.termination = Termination::Gradient;
                return outcome;
            }
            outcome.factorizations += 1;
            // Only a singular matrix is damped; the radius does the rest.
            let Some(newton_step) = self.solve(damping, &mut outcome.undetermined) else {
                outcome.iterations += 1;
                outcome.rejected += 1;
                damping = if damping == 0.0 { FIRST_DAMPING } else { damping * 10.0 };
                if damping > LARGEST_DAMPING {
                    outcome.termination = Termination::Stalled;
                    return outcome;
                }
                continue;
            };
            damping = 0.0;
            outcome.last = newton_step;
            let met = newton_step.met(self.at_least(outcome.cost), false, options);
            let newton = self.step.clone();
            let cauchy = self.cauchy_step();
            if radius.is_infinite() {
                radius = self.scaled_norm(&newton);
            }
            loop {
                outcome.iterations += 1;
                self.blend(&newton, &cauchy, if met.is_some() { f64::INFINITY } else { radius });
                let promised = self.promise();
                let length = self.scaled_norm(&self.step);
                self.retract(poses);
                let cost = self.trial_cost(edges);
                if cost < outcome.cost || (met.is_some() && cost <= outcome.cost) {
                    let gain = (outcome.cost - cost) / promised;
                    if gain > GOOD {
                        radius = radius.max(3.0 * length);
                    } else if gain < POOR {
                        radius *= 0.5;
                    }
                    poses.copy_from_slice(&self.trial);
                    outcome.cost = cost;
                    break;
                }
                if met.is_some() {
                    break;
                }
                if newton_step.promised <= rounding(edges, poses) {
                    outcome.termination = Termination::Cost;
                    return outcome;
                }
                outcome.rejected += 1;
                radius = 0.5 * radius.min(length);
                if !(radius > smallest_radius) || outcome.iterations >= options.max_iterations {
                    outcome.termination = if radius > smallest_radius {
                        Termination::IterationLimit
                    } else {
                        Termination::Stalled
                    };
                    return outcome;
                }
            }
            if let Some(termination) = met {
                outcome.termination = termination;
                return outcome;
            }
            self.assemble(edges, poses);
        }
        outcome
    }

    /// The minimum of the model along `-diag(H)^-1 g`.
    fn cauchy_step(&self) -> Steps<DOF> {
        let direction: Steps<DOF> = self
            .equations
            .gradient
            .iter()
            .zip(&self.equations.diagonal)
            .map(|(gradient, block)| {
                SVector::from_fn(|row, _| {
                    let entry = block[(row, row)];
                    if entry > 0.0 { -gradient[row] / entry } else { 0.0 }
                })
            })
            .collect();
        let slope: f64 = direction.iter().zip(&self.equations.gradient).map(|(d, g)| d.dot(g)).sum();
        let curvature = self.equations.curvature(self.pattern, &direction);
        let length = if curvature > 0.0 { -slope / curvature } else { 0.0 };
        direction.into_iter().map(|block| block * length).collect()
    }

    /// Sets the step to the point of the dogleg at this distance.
    fn blend(&mut self, newton: &Steps<DOF>, cauchy: &Steps<DOF>, radius: f64) {
        if self.scaled_norm(newton) <= radius {
            self.step.copy_from_slice(newton);
            return;
        }
        let short = self.scaled_norm(cauchy);
        if short >= radius {
            let share = radius / short;
            self.step.iter_mut().zip(cauchy).for_each(|(step, cauchy)| *step = cauchy * share);
            return;
        }
        // |c + b (n - c)| = radius has one root between 0 and 1; this form of it does not cancel.
        let difference: Steps<DOF> = newton.iter().zip(cauchy).map(|(n, c)| n - c).collect();
        let square = self.scaled_dot(&difference, &difference);
        let half = self.scaled_dot(cauchy, &difference);
        let rest = radius * radius - short * short;
        let root = (half * half + square * rest).sqrt();
        let share = if half > 0.0 { rest / (half + root) } else { (root - half) / square };
        for ((step, cauchy), difference) in self.step.iter_mut().zip(cauchy).zip(&difference) {
            *step = cauchy + difference * share;
        }
    }

    /// By how much the step would lower a quadratic cost: `-2 g^T d - d^T H d`.
    fn promise(&self) -> f64 {
        let slope: f64 = self.step.iter().zip(&self.equations.gradient).map(|(d, g)| d.dot(g)).sum();
        -2.0 * slope - self.equations.curvature(self.pattern, &self.step)
    }

    fn scaled_dot(&self, a: &Steps<DOF>, b: &Steps<DOF>) -> f64 {
        let blocks = a.iter().zip(b).zip(&self.equations.diagonal);
        blocks.map(|((a, b), block)| a.component_mul(&block.diagonal()).dot(b)).sum()
    }

    fn scaled_norm(&self, a: &Steps<DOF>) -> f64 {
        self.scaled_dot(a, a).sqrt()
    }
}

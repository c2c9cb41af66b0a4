//! Powell's dogleg: a step between steepest descent and Gauss-Newton, no longer than the radius in which the model is
//! trusted.
//!
//! M. J. D. Powell, "A hybrid method for nonlinear equations", 1970; K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for
//! non-linear least squares problems", 2004, section 3.3. Lengths are measured in the norm of `diag(H)`, which is free of
//! units.

use nalgebra::SVector;

use super::damping::{FIRST_DAMPING, LARGEST_DAMPING};
use super::outcome::{Outcome, Step, Termination};
use super::workspace::Workspace;
use crate::model::lanes::LaneGroup;
use crate::model::term::Term;
use crate::options::Options;

/// Ratios of gain to promise: below the first a step halves the radius, above the second the radius may grow.
const POOR: f64 = 0.25;
const GOOD: f64 = 0.75;
/// A radius below this is rounding; 1 means a step of the graph's length and of one radian in every pose.
const SMALLEST_RADIUS: f64 = 1e-14;

type Steps<const DOF: usize> = Vec<SVector<f64, DOF>>;

/// The two corners of the dogleg, which starts at the zero step.
struct Legs<const DOF: usize> {
    /// The minimum along the direction of steepest descent.
    cauchy: Steps<DOF>,
    /// The Gauss-Newton step, with its measures in `full`.
    newton: Steps<DOF>,
    full: Step,
    /// The tolerance that the Gauss-Newton step meets: such a step is tried at any radius.
    met: Option<Termination>,
}

/// The region in which the model is trusted.
struct Region {
    radius: f64,
    /// A radius below this is rounding.
    smallest: f64,
}

impl<G: LaneGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Minimises the cost of the edges over all poses that are not held. A failed step costs no factorisation.
    pub(crate) fn minimise_by_dogleg<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
    ) -> Outcome {
        let mut outcome = Outcome::new(self.assemble(edges, poses));
        // The first radius is the length of the first Gauss-Newton step, since nothing is known yet against this step.
        let mut region =
            Region { radius: f64::INFINITY, smallest: SMALLEST_RADIUS * self.magnitude.cost.sqrt() };
        let mut damping = 0.0;
        while outcome.iterations < options.max_iterations {
            outcome.gradient = self.cosine(outcome.cost);
            if outcome.gradient <= options.gradient_tolerance {
                outcome.termination = Termination::Gradient;
                return outcome;
            }
            outcome.factorizations += 1;
            // Only a singular matrix is damped; otherwise the radius limits the step.
            let Some(full) = self.solve(damping, &mut outcome.undetermined) else {
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
            outcome.last = full;
            let met = full.met(self.at_least(outcome.cost), false, options);
            let legs = Legs { cauchy: self.cauchy_step(), newton: self.step.clone(), full, met };
            if region.radius.is_infinite() {
                region.radius = self.scaled_norm(&legs.newton);
            }
            if let Some(termination) = self.search(edges, poses, options, &legs, &mut region, &mut outcome) {
                outcome.termination = termination;
                return outcome;
            }
            self.assemble(edges, poses);
        }
        outcome
    }

    /// Tries points of the dogleg at smaller and smaller radii until one lowers the cost. Returns the reason if the iteration
    /// ends.
    fn search<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        legs: &Legs<DOF>,
        region: &mut Region,
        outcome: &mut Outcome,
    ) -> Option<Termination> {
        let Legs { cauchy, newton, full, met } = legs;
        loop {
            outcome.iterations += 1;
            self.blend(newton, cauchy, if met.is_some() { f64::INFINITY } else { region.radius });
            let promised = self.promise();
            let length = self.scaled_norm(&self.step);
            self.retract(poses);
            let cost = self.trial_cost(edges);
            if cost < outcome.cost || (met.is_some() && cost <= outcome.cost) {
                let gain = (outcome.cost - cost) / promised;
                if gain > GOOD {
                    region.radius = region.radius.max(3.0 * length);
                } else if gain < POOR {
                    region.radius *= 0.5;
                }
                poses.copy_from_slice(&self.trial);
                outcome.cost = cost;
                return *met;
            }
            if met.is_some() {
                return *met;
            }
            if full.promised <= self.rounding(edges, poses) {
                // Even the full step promises too little to be seen in the cost.
                return Some(Termination::Cost);
            }
            outcome.rejected += 1;
            // Half the length of the step that failed: a radius beyond the Gauss-Newton step would give the same step again.
            region.radius = 0.5 * region.radius.min(length);
            if !(region.radius > region.smallest) {
                return Some(Termination::Stalled);
            }
            if outcome.iterations >= options.max_iterations {
                return Some(Termination::IterationLimit);
            }
        }
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
                    // A direction that no edge measures has no gradient, either: rounding errors must not become a step.
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
        // |c + b (n - c)| = radius has one root between 0 and 1; this form of the root avoids cancellation.
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

    /// The decrease of a quadratic cost by the step: `-2 g^T d - d^T H d`.
    fn promise(&self) -> f64 {
        let slope: f64 = self.step.iter().zip(&self.equations.gradient).map(|(d, g)| d.dot(g)).sum();
        -2.0 * slope - self.equations.curvature(self.pattern, &self.step)
    }

    fn scaled_dot(&self, a: &[SVector<f64, DOF>], b: &[SVector<f64, DOF>]) -> f64 {
        let blocks = a.iter().zip(b).zip(&self.equations.diagonal);
        blocks.map(|((a, b), block)| a.component_mul(&block.diagonal()).dot(b)).sum()
    }

    /// The norm of `diag(H)`.
    pub(super) fn scaled_norm(&self, a: &[SVector<f64, DOF>]) -> f64 {
        self.scaled_dot(a, a).sqrt()
    }
}

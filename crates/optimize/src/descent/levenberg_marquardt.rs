//! Gauss-Newton on the manifold, damped after a step that fails.
//!
//! K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear least squares problems", 2004, section 3.2, with the
//! scaling of Marquardt and a damping that starts at zero: starts are mostly near the minimum, where undamped steps converge
//! quadratically and damping would only make them shorter.

use posecut_geometry::LieGroup;

use super::damping::Damping;
use super::outcome::{Outcome, Step, Termination};
use super::phases::timed;
use super::workspace::{Workspace, rounding};
use crate::model::residual::Term;
use crate::options::Options;

/// Damping up to which the tolerances of a full step apply: a stronger one makes steps short wherever they are, and a short step would
/// pass for convergence.
const NEARLY_FULL: f64 = 1e-3;

/// An iteration under way.
struct Iteration {
    damping: Damping,
    /// The longest component of the last undamped step.
    undamped_before: f64,
    outcome: Outcome,
}

/// A step that was tried.
struct Tried {
    step: Step,
    /// The cost at the trial.
    cost: f64,
    /// The tolerance that the step meets.
    met: Option<Termination>,
    /// Whether it is a full step.
    undamped: bool,
}

impl<G: LieGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Minimises by Gauss-Newton steps, damped up to a limit after one fails.
    pub(super) fn minimise_damped<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        largest_damping: f64,
    ) -> Outcome {
        let mut iteration = Iteration {
            damping: Damping::up_to(largest_damping),
            undamped_before: f64::INFINITY,
            outcome: Outcome::new(self.assemble(edges, poses)),
        };
        let mut ended = self.is_flat(options, &mut iteration.outcome);
        while ended.is_none() && iteration.outcome.iterations < options.max_iterations {
            ended = self.damped_step(edges, poses, options, &mut iteration);
        }
        if let Some(termination) = ended {
            iteration.outcome.termination = termination;
        }
        iteration.outcome
    }

    /// Notes how large the gradient is; whether that ends the iteration.
    fn is_flat(&self, options: &Options, outcome: &mut Outcome) -> Option<Termination> {
        outcome.gradient = self.cosine(outcome.cost);
        (outcome.gradient <= options.gradient_tolerance).then_some(Termination::Gradient)
    }

    /// Tries a step, takes it if it lowers the cost, and damps the next one more if not. Says why the iteration ends, if it does.
    fn damped_step<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        iteration: &mut Iteration,
    ) -> Option<Termination> {
        let Iteration { damping, undamped_before, outcome } = iteration;
        outcome.iterations += 1;
        outcome.factorizations += 1;
        let Some(step) = self.solve(damping.value, &mut outcome.undetermined) else {
            outcome.rejected += 1;
            return (!damping.raise()).then_some(Termination::Stalled);
        };
        let undamped = damping.value == 0.0;
        let shrinks = undamped && step.largest < *undamped_before;
        if undamped {
            *undamped_before = step.largest;
        }
        outcome.last = step;
        self.retract(poses);
        let met = if damping.value <= NEARLY_FULL {
            step.met(self.at_least(outcome.cost), shrinks, options)
        } else {
            None
        };
        // With the gradient at the trial the next step can take the same factor; after a damped step none does.
        let cost =
            if undamped && met.is_none() { self.trial_gradient(edges) } else { self.trial_cost(edges) };
        let lower =
            cost < outcome.cost || (shrinks && options.is_hidden(step.promised, self.at_least(outcome.cost)));
        // A last step may leave the cost as it is: the poses are nearer to the minimum all the same.
        if lower || (met.is_some() && cost <= outcome.cost) {
            return self.take(edges, poses, options, iteration, &Tried { step, cost, met, undamped });
        }
        if met.is_some() {
            return met;
        }
        if damping.value <= NEARLY_FULL && step.promised <= rounding(edges, poses) {
            // The cost cannot show whether the step keeps its promise.
            return Some(Termination::Cost);
        }
        outcome.rejected += 1;
        if !damping.raise() {
            return Some(Termination::Stalled);
        }
        if undamped {
            // The trial's gradient has taken the place of that here.
            let Self { equations, pattern, phases, .. } = self;
            timed(&mut phases.linearisation, || {
                equations.assemble_gradient(pattern, edges, poses);
            });
        }
        None
    }

    /// Takes the trial, goes on with its factor while that pays, and makes the equations anew.
    fn take<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        iteration: &mut Iteration,
        tried: &Tried,
    ) -> Option<Termination> {
        let Iteration { damping, undamped_before, outcome } = iteration;
        poses.copy_from_slice(&self.trial);
        let gain = (outcome.cost - tried.cost) / tried.step.promised;
        outcome.cost = tried.cost;
        if tried.met.is_some() {
            return tried.met;
        }
        damping.lower(gain);
        if tried.undamped {
            // Only the factor of an undamped matrix gives steps that approach Newton's.
            if let Some(termination) = self.reuse(edges, poses, options, &tried.step, outcome) {
                return Some(termination);
            }
            *undamped_before = outcome.last.largest;
        }
        outcome.cost = self.assemble(edges, poses);
        self.is_flat(options, outcome)
    }
}

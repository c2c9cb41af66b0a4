//! Gauss-Newton on the manifold, damped after a step that fails.
//!
//! K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear least squares problems", 2004, section 3.2, with
//! Marquardt's scaling. Damping starts at zero: most starts are near the minimum, where undamped steps converge quadratically
//! and damping would only shorten them.

use posecut_geometry::LieGroup;

use super::contest::Attempt;
use super::damping::{Damping, FIRST_DAMPING, first_damping};
use super::outcome::{Outcome, Termination};
use super::workspace::Workspace;
use crate::model::residual::Term;
use crate::options::Options;

/// The tolerances of a full step apply up to this damping. Stronger damping makes steps short everywhere, and a short step
/// would pass for convergence.
const NEARLY_FULL: f64 = 1e-3;

/// Below this share of its promise, other steps are tried beside a step.
const GOOD: f64 = 0.9;
/// A step that keeps less than this share of its promise counts as failed for the steps after it, though it is taken.
const POOR: f64 = 0.25;
/// Factorisations after which Newton's step is tried, too. Most graphs need fewer, and far from a minimum it is no better.
const PATIENCE: usize = 10;

/// The state of an iteration.
struct Iteration {
    damping: Damping,
    /// The longest component of the last undamped step.
    undamped_before: f64,
    /// Whether a step has failed.
    hard: bool,
    outcome: Outcome,
}

/// A step that was tried.
struct Tried {
    attempt: Attempt,
    /// The tolerance that the step meets.
    met: Option<Termination>,
    /// Whether it is a full step.
    undamped: bool,
    /// Whether the equations have the trial's gradient.
    with_gradient: bool,
}

impl<G: LieGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Minimises by Gauss-Newton steps. After a step fails, they are damped, up to a limit.
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
            hard: false,
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

    /// Notes the size of the gradient; returns whether it ends the iteration.
    fn is_flat(&self, options: &Options, outcome: &mut Outcome) -> Option<Termination> {
        outcome.gradient = self.cosine(outcome.cost);
        (outcome.gradient <= options.gradient_tolerance).then_some(Termination::Gradient)
    }

    /// Tries a step. Takes it if it lowers the cost, otherwise increases damping. Returns the reason if the iteration ends.
    fn damped_step<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        iteration: &mut Iteration,
    ) -> Option<Termination> {
        let Iteration { damping, undamped_before, hard, outcome } = iteration;
        outcome.iterations += 1;
        outcome.factorizations += 1;
        let Some(step) = self.solve(damping.value, &mut outcome.undetermined) else {
            outcome.rejected += 1;
            return (!damping.raise(FIRST_DAMPING)).then_some(Termination::Stalled);
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
        // With the gradient at the trial, the next step can reuse the factor. After a damped step none does.
        let with_gradient = undamped && met.is_none() && !*hard;
        let cost = if with_gradient { self.trial_gradient(edges) } else { self.trial_cost(edges) };
        let mut attempt = Attempt { step, cost };
        if *hard && met.is_none() && !(attempt.gain(outcome.cost) >= GOOD) {
            let newton = outcome.factorizations > PATIENCE;
            attempt = self.contest(edges, poses, damping.value, newton, attempt);
        }
        let Attempt { step, cost } = attempt;
        let lower =
            cost < outcome.cost || (shrinks && options.is_hidden(step.promised, self.at_least(outcome.cost)));
        // The last step may leave the cost unchanged: its poses are still nearer to the minimum.
        if lower || (met.is_some() && cost <= outcome.cost) {
            return self.take(
                edges,
                poses,
                options,
                iteration,
                &Tried { attempt, met, undamped, with_gradient },
            );
        }
        if met.is_some() {
            return met;
        }
        if damping.value <= NEARLY_FULL && step.promised <= self.rounding(edges, poses) {
            // The promise is too small to be seen in the cost.
            return Some(Termination::Cost);
        }
        outcome.rejected += 1;
        *hard = true;
        if with_gradient {
            // The trial's gradient has overwritten the gradient at these poses.
            self.assemble_gradient(edges, poses);
        }
        let first = first_damping(self.stiffness(&step, damping.value), attempt.gain(outcome.cost));
        (!damping.raise(first)).then_some(Termination::Stalled)
    }

    /// Takes the trial, continues with its factor while that pays, and then assembles the equations anew.
    fn take<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        iteration: &mut Iteration,
        tried: &Tried,
    ) -> Option<Termination> {
        let Iteration { damping, undamped_before, hard, outcome } = iteration;
        let Attempt { step, cost } = tried.attempt;
        let gain = tried.attempt.gain(outcome.cost);
        let damped_by = damping.value;
        if !tried.undamped {
            damping.lower(gain, self.stiffness(&step, damped_by));
        }
        poses.copy_from_slice(&self.trial);
        outcome.cost = cost;
        if tried.met.is_some() {
            return tried.met;
        }
        if gain < POOR && outcome.factorizations > PATIENCE {
            *hard = true;
            if damping.value == 0.0 {
                damping.start(first_damping(self.stiffness(&step, damped_by), gain));
            }
        } else if tried.undamped {
            // Only the factor of an undamped matrix gives steps that approach Newton's.
            if !tried.with_gradient {
                self.trial_gradient(edges);
            }
            if let Some(termination) = self.reuse(edges, poses, options, &step, outcome) {
                return Some(termination);
            }
            *undamped_before = outcome.last.largest;
        }
        outcome.cost = self.assemble(edges, poses);
        self.is_flat(options, outcome)
    }
}

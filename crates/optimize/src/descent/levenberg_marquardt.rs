//! Gauss-Newton on the manifold, damped after a step that fails.
//!
//! K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear least squares problems", 2004, section 3.2, with
//! Marquardt's scaling. Damping starts at zero: most starts are near the minimum, where undamped steps converge quadratically
//! and damping would only shorten them.

use super::contest::Attempt;
use super::damping::{Damping, FIRST_DAMPING, first_damping};
use super::outcome::{Outcome, Step, Termination};
use super::pace::Pace;
use super::workspace::Workspace;
use crate::model::lanes::LaneGroup;
use crate::model::term::Term;
use crate::options::Options;

/// The tolerances of a full step apply up to this damping. Stronger damping makes steps short everywhere, and a short step
/// would pass for convergence.
const NEARLY_FULL: f64 = 1e-3;

/// After a step with a component of this length (shares of the graph's length, radians), the matrix has mostly changed too much for
/// another step with the old factor, so gradient and matrix are computed in one pass.
pub(super) const LONG: f64 = 0.25;

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
    pace: Pace,
    outcome: Outcome,
}

/// What the equations have of a trial.
#[derive(Clone, Copy, PartialEq)]
enum Assembled {
    /// Nothing: they are those of the poses before it.
    Nothing,
    /// The gradient.
    Gradient,
    /// Gradient and matrix.
    Whole,
}

/// A step that was tried.
struct Tried {
    attempt: Attempt,
    /// The tolerance that the step meets.
    met: Option<Termination>,
    /// Whether it is a full step.
    undamped: bool,
    /// Whether it was found by conjugate gradients.
    conjugate: bool,
    /// What the equations have of the trial.
    equations: Assembled,
}

impl<G: LaneGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Minimises by Gauss-Newton steps. After a step fails, they are damped, up to a limit.
    pub(super) fn minimise_damped<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        largest_damping: f64,
    ) -> Outcome {
        // The factor is that of an earlier descent, if any.
        self.is_near = false;
        let mut iteration = Iteration {
            damping: Damping::up_to(largest_damping),
            undamped_before: f64::INFINITY,
            hard: false,
            pace: Pace::new(),
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
        let Iteration { damping, undamped_before, hard, pace, outcome } = iteration;
        outcome.iterations += 1;
        let undamped = damping.value == 0.0;
        let enough = options.promise_tolerance(self.at_least(outcome.cost));
        // Newton's step needs a factor of these poses.
        let easy = !*hard && pace.radius().is_none();
        let conjugate = if undamped && easy { self.conjugate_step(enough) } else { None };
        let step = conjugate.or_else(|| {
            outcome.factorizations += 1;
            self.solve(damping.value, &mut outcome.undetermined)
        });
        let Some(step) = step else {
            outcome.rejected += 1;
            return (!damping.raise(FIRST_DAMPING)).then_some(Termination::Stalled);
        };
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
        let equations = match undamped && met.is_none() && easy {
            false => Assembled::Nothing,
            true if step.largest < LONG && conjugate.is_none() => Assembled::Gradient,
            true => Assembled::Whole,
        };
        let final_or_hidden = met.is_some() || options.is_hidden(step.promised, self.at_least(outcome.cost));
        let before = if final_or_hidden { None } else { Some(outcome.cost) };
        let mut attempt = self.evaluate(edges, poses, step, equations, before);
        if *hard && met.is_none() && !(attempt.gain(outcome.cost) >= GOOD) {
            let newton = outcome.factorizations > PATIENCE;
            attempt = self.contest(edges, poses, damping.value, newton, outcome.cost, attempt);
        } else if met.is_none() {
            attempt = self.or_newton(edges, poses, damping.value, pace, outcome.cost, attempt);
        }
        pace.note(&step, undamped && outcome.factorizations > self.patience);
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
                &Tried { attempt, met, undamped, conjugate: conjugate.is_some(), equations },
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
        *hard |= conjugate.is_none();
        self.restore(edges, poses, equations);
        if conjugate.is_some() {
            // The same step follows, with a new factor.
            return None;
        }
        let first = first_damping(self.stiffness(&step, damping.value), attempt.gain(outcome.cost));
        (!damping.raise(first)).then_some(Termination::Stalled)
    }

    /// Computes again what the trial has overwritten of the equations at these poses.
    fn restore<T: Term<G, DOF>>(&mut self, edges: &[T], poses: &[G], overwritten: Assembled) {
        match overwritten {
            Assembled::Nothing => {}
            Assembled::Gradient => {
                self.assemble_gradient(edges, poses);
            }
            Assembled::Whole => {
                self.assemble(edges, poses);
            }
        }
    }

    /// Evaluates the trial. If a cost `before` is given and the step keeps too little of its promise, also evaluates the step along screws;
    /// the better of both becomes the trial.
    fn evaluate<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &[G],
        step: Step,
        wanted: Assembled,
        before: Option<f64>,
    ) -> Attempt {
        let assembled = |workspace: &mut Self| match wanted {
            Assembled::Nothing => workspace.trial_cost(edges),
            Assembled::Gradient => workspace.trial_gradient(edges),
            Assembled::Whole => workspace.trial_equations(edges),
        };
        let attempt = Attempt { step, cost: assembled(self) };
        if before.is_some_and(|before| !(attempt.gain(before) >= POOR))
            && let Some(better) = self.by_screws(edges, poses, attempt)
        {
            return if wanted == Assembled::Nothing {
                better
            } else {
                Attempt { step, cost: assembled(self) }
            };
        }
        attempt
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
        let Iteration { damping, undamped_before, hard, outcome, .. } = iteration;
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
            if tried.equations == Assembled::Nothing {
                self.trial_gradient(edges);
            }
            let before = outcome.iterations;
            if tried.conjugate {
                self.is_near = gain >= POOR;
            } else if let Some(termination) = self.reuse(edges, poses, options, &step, outcome) {
                return Some(termination);
            }
            *undamped_before = outcome.last.largest;
            if tried.equations == Assembled::Whole && outcome.iterations == before {
                return self.is_flat(options, outcome);
            }
        }
        outcome.cost = self.assemble(edges, poses);
        self.is_flat(options, outcome)
    }
}

//! Gauss-Newton on the manifold, damped after a step that fails.
//!
//! K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for non-linear least squares problems", 2004, section 3.2, with the
//! scaling of Marquardt and a damping that starts at zero.

use posecut_geometry::LieGroup;

use super::damping::Damping;
use super::outcome::{Outcome, Termination};
use super::phases::timed;
use super::workspace::{Workspace, rounding};
use crate::model::residual::Term;
use crate::options::Options;

/// Damping up to which the tolerances of a full step apply.
const NEARLY_FULL: f64 = 1e-3;

impl<G: LieGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Minimises by Gauss-Newton steps, damped up to a limit after one fails.
    pub(super) fn minimise_damped<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        largest_damping: f64,
    ) -> Outcome {
        let mut damping = Damping::up_to(largest_damping);
        let mut outcome = Outcome::new(self.assemble(edges, poses));
        outcome.gradient = self.cosine(outcome.cost);
        if outcome.gradient <= options.gradient_tolerance {
            outcome.termination = Termination::Gradient;
            return outcome;
        }
        // The longest component of the last undamped step.
        let mut undamped_before = f64::INFINITY;
        while outcome.iterations < options.max_iterations {
            outcome.iterations += 1;
            outcome.factorizations += 1;
            let Some(step) = self.solve(damping.value, &mut outcome.undetermined) else {
                outcome.rejected += 1;
                if !damping.raise() {
                    outcome.termination = Termination::Stalled;
                    break;
                }
                continue;
            };
            let undamped = damping.value == 0.0;
            let shrinks = undamped && step.largest < undamped_before;
            if undamped {
                undamped_before = step.largest;
            }
            outcome.last = step;
            self.retract(poses);
            let met = if damping.value <= NEARLY_FULL {
                step.met(self.at_least(outcome.cost), shrinks, options)
            } else {
                None
            };
            // The gradient at the trial is what the next step starts from, if it is taken.
            let cost =
                if undamped && met.is_none() { self.trial_gradient(edges) } else { self.trial_cost(edges) };
            let lower = cost < outcome.cost
                || (shrinks && options.is_hidden(step.promised, self.at_least(outcome.cost)));
            if lower || (met.is_some() && cost <= outcome.cost) {
                poses.copy_from_slice(&self.trial);
                let gain = (outcome.cost - cost) / step.promised;
                outcome.cost = cost;
                if let Some(termination) = met {
                    outcome.termination = termination;
                    break;
                }
                damping.lower(gain);
                if undamped && let Some(termination) = self.reuse(edges, poses, options, &step, &mut outcome)
                {
                    outcome.termination = termination;
                    break;
                }
                if undamped {
                    undamped_before = outcome.last.largest;
                }
                outcome.cost = self.assemble(edges, poses);
                outcome.gradient = self.cosine(outcome.cost);
                if outcome.gradient <= options.gradient_tolerance {
                    outcome.termination = Termination::Gradient;
                    break;
                }
            } else if let Some(termination) = met {
                outcome.termination = termination;
                break;
            } else if damping.value <= NEARLY_FULL && step.promised <= rounding(edges, poses) {
                // The cost cannot show whether the step keeps its promise.
                outcome.termination = Termination::Cost;
                break;
            } else {
                outcome.rejected += 1;
                if !damping.raise() {
                    outcome.termination = Termination::Stalled;
                    break;
                }
                if undamped {
                    let Self { equations, pattern, phases, .. } = self;
                    timed(&mut phases.linearisation, || {
                        equations.assemble_gradient(pattern, edges, poses);
                    });
                }
            }
        }
        outcome
    }
}

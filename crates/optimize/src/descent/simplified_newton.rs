//! Steps with the factor of an earlier step.
//!
//! Near the minimum the matrix hardly changes from step to step. So `d = -A^-1 g` with the new gradient `g` and the old
//! matrix `A` is nearly the Gauss-Newton step, without a factorisation. The iteration converges linearly, and faster the
//! nearer the factor's poses are to the minimum (simplified Newton; P. Deuflhard, "Newton methods for nonlinear problems",
//! 2004, section 2.1.2). The promise of its first step also shows, at almost no cost, whether another full step is needed.

use posecut_cholesky::vectors::dot;

use super::levenberg_marquardt::LONG;
use super::outcome::{Outcome, Step, Termination};
use super::workspace::Workspace;
use crate::model::lanes::LaneGroup;
use crate::model::term::Term;
use crate::options::Options;

/// The old factor is not used any more if the ratio of successive promises exceeds this.
const SLOW: f64 = 0.2;
/// A first step with the old factor that is longer than the step before fails more often than not; after a long one, where it is longer than
/// this share.
const FIRST_SHARE: f64 = 0.25;
/// After a step with a longer component (shares of the graph's length, radians), not even the first step with the old factor pays.
const FAR: f64 = 1.0;
/// Time of a step with a new factor, in steps with the old one: 3 to 7 on the benchmark graphs.
const STEPS_PER_FACTOR: f64 = 4.0;

impl<G: LaneGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Continues with the factor of the last step, which promised `last`, as long as that is faster than a new factor.
    /// `poses` are the poses after that step; the gradient and `outcome.cost` belong to them. Returns the tolerance that was
    /// met, if any.
    pub(crate) fn reuse<T: Term<G, DOF>>(
        &mut self,
        edges: &[T],
        poses: &mut [G],
        options: &Options,
        last: &Step,
        outcome: &mut Outcome,
    ) -> Option<Termination> {
        let mut before = last.promised;
        // If full steps converge quadratically with rate r, the first step with an old factor has rate 4 r: its error is the
        // product of the last two errors instead of the square of the last one, and the derivative of a square doubles it.
        let mut slowdown = 4.0;
        let mut longest = if last.largest < LONG { last.largest } else { FIRST_SHARE * last.largest };
        // Whether the last step went beyond the minimum along it.
        let mut overshot = false;
        self.is_near = false;
        if last.largest > FAR {
            return None;
        }
        while outcome.iterations < options.max_iterations {
            outcome.gradient = self.cosine(outcome.cost);
            if outcome.gradient <= options.gradient_tolerance {
                return Some(Termination::Gradient);
            }
            let step = self.substitute()?;
            let ratio = step.promised / before;
            self.is_near |= ratio < SLOW;
            let shrinks = step.largest < outcome.last.largest;
            let at_least = self.at_least(outcome.cost);
            let met = step.met(at_least, shrinks, options);
            // Where steps go too far, the old matrix is the softer one, and its promises are too large.
            let is_sure = ratio < SLOW || (overshot && met.is_some());
            if !is_sure || !(step.largest < longest) {
                return None;
            }
            let hidden = shrinks && options.is_hidden(step.promised, at_least);
            if met.is_none()
                && !pays(step.promised, ratio, slowdown * ratio, options.promise_tolerance(at_least))
            {
                return None;
            }
            outcome.iterations += 1;
            outcome.last = step;
            self.retract(poses);
            let cost = if met.is_some() { self.trial_cost(edges) } else { self.trial_gradient(edges) };
            let lower = cost < outcome.cost || hidden;
            if lower || (met.is_some() && cost <= outcome.cost) {
                poses.copy_from_slice(&self.trial);
                outcome.cost = cost;
            } else if met.is_none() {
                outcome.rejected += 1;
            }
            if met.is_some() || !lower {
                return met;
            }
            overshot = dot(&self.step, &self.equations.gradient) > 0.0;
            before = step.promised;
            slowdown = 1.0;
            longest = f64::INFINITY;
        }
        None
    }
}

/// Whether steps with the old factor, each promising `rate` times its predecessor, reach the tolerance sooner than full
/// steps. The rate of full steps was `ratio` and is squared every time.
fn pays(promised: f64, ratio: f64, rate: f64, tolerance: f64) -> bool {
    if rate >= 1.0 {
        return false;
    }
    let steps = ((tolerance / promised).ln() / rate.ln()).ceil();
    let (mut full, mut rest, mut ratio) = (1.0, promised, ratio);
    while rest > tolerance {
        ratio *= ratio;
        rest *= ratio;
        full += 1.0;
    }
    steps <= STEPS_PER_FACTOR * full
}

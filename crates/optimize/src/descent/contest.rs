//! Which of several steps lowers the cost most.
//!
//! Where the poses bend, the step that the linear model proposes is good and its retraction is not, or the residuals curve and the
//! step itself is not good. A factorisation costs several times as much as a trial, so all are tried: the Gauss-Newton step
//! and, after a number of factorisations, Newton's, each moved pose by pose and along the stiffest edges. Where only the latter helps, the
//! Gauss-Newton step is also tried with a correction of second order ([`acceleration`](super::acceleration)).

use nalgebra::SVector;

use super::outcome::Step;
use super::pace::Pace;
use super::stiff_tree::StiffTree;
use super::workspace::Workspace;
use crate::model::lanes::LaneGroup;
use crate::model::term::Term;

/// A step and the cost where it leads.
#[derive(Clone, Copy)]
pub(super) struct Attempt {
    pub(super) step: Step,
    pub(super) cost: f64,
}

impl Attempt {
    /// The share of its promise that the step keeps.
    pub(super) fn gain(&self, before: f64) -> f64 {
        (before - self.cost) / self.step.promised
    }
}

impl<G: LaneGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// The best of the given attempt, which is at the trial, and the other steps. Its poses become the trial, its step the step.
    pub(super) fn contest<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        damping: f64,
        newton: bool,
        before: f64,
        first: Attempt,
    ) -> Attempt {
        let held = self.pattern.held;
        if self.tree.is_none() {
            self.tree = Some(StiffTree::new(terms, poses.len(), held, self.magnitude.length));
        }
        let mut best = first;
        let mut winner = (self.trial.clone(), self.step.clone());
        self.by_tree(terms, poses, first.step, &mut best, &mut winner);
        // The step fails, and the tree is what it lacks.
        if first.cost > before && best.cost < first.cost {
            self.accelerate(terms, poses, first.step, &mut best, &mut winner);
        }
        if newton
            && let Some(attempt) =
                self.by_newton(terms, poses, damping, f64::INFINITY, &mut best, &mut winner)
        {
            self.by_tree(terms, poses, attempt.step, &mut best, &mut winner);
        }
        (self.trial, self.step) = winner;
        best
    }

    /// The better of the given attempt, which is at the trial, and, if the descent creeps, Newton's step. Its poses become the trial, its step
    /// the step.
    pub(super) fn or_newton<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        damping: f64,
        pace: &mut Pace,
        before: f64,
        first: Attempt,
    ) -> Attempt {
        let Some(radius) = pace.radius() else { return first };
        let mut best = first;
        let mut winner = (self.trial.clone(), self.step.clone());
        let newton = self.by_newton(terms, poses, damping, radius, &mut best, &mut winner);
        pace.adapt(newton.map_or(f64::NAN, |attempt| attempt.gain(before)));
        (self.trial, self.step) = winner;
        best
    }

    /// The attempt to move poses along screws, if it costs less than the given one, which is at the trial. Its poses then become the trial.
    pub(super) fn by_screws<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        first: Attempt,
    ) -> Option<Attempt> {
        let apart = std::mem::take(&mut self.trial);
        self.retract_by_screws(poses);
        let cost = self.trial_cost(terms);
        if cost < first.cost || !first.cost.is_finite() {
            return Some(Attempt { cost, ..first });
        }
        self.trial = apart;
        None
    }

    /// Tries Newton's step; returns it if there is one.
    fn by_newton<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        damping: f64,
        radius: f64,
        best: &mut Attempt,
        winner: &mut Winner<G, DOF>,
    ) -> Option<Attempt> {
        let step = self.newton_step(terms, poses, damping, radius)?;
        // The exact second derivative is that along screws.
        self.retract_by_screws(poses);
        let attempt = Attempt { step, cost: self.trial_cost(terms) };
        self.prefer(attempt, best, winner);
        Some(attempt)
    }

    /// Tries the step along the tree.
    fn by_tree<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        step: Step,
        best: &mut Attempt,
        winner: &mut Winner<G, DOF>,
    ) {
        if let Some(tree) = self.tree.as_ref().filter(|tree| !tree.is_empty()) {
            tree.retract(poses, self.pattern.held, &self.step, &mut self.trial);
            let cost = self.trial_cost(terms);
            self.prefer(Attempt { step, cost }, best, winner);
        }
    }

    /// Keeps the attempt at the trial if it costs less than the best so far.
    pub(super) fn prefer(&self, attempt: Attempt, best: &mut Attempt, winner: &mut Winner<G, DOF>) {
        // Also where the best so far is not a number.
        if attempt.cost < best.cost || !best.cost.is_finite() {
            *best = attempt;
            winner.0.copy_from_slice(&self.trial);
            winner.1.copy_from_slice(&self.step);
        }
    }
}

/// Poses and step of the best attempt.
pub(super) type Winner<G, const DOF: usize> = (Vec<G>, Vec<SVector<f64, DOF>>);

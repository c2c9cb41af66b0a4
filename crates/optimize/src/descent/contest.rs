//! Which of several steps lowers the cost most.
//!
//! Where the poses bend, the step that the linear model proposes is good and its retraction is not, or the residuals curve and the
//! step itself is not good. A factorisation costs several times as much as a trial, so all are tried: the Gauss-Newton step
//! and, after a number of factorisations, Newton's, each moved pose by pose and along the stiffest edges. Where only the latter helps, the
//! Gauss-Newton step is also tried with a correction of second order ([`acceleration`](super::acceleration)).

use nalgebra::SVector;
use posecut_geometry::{LieGroup, translations};

use super::outcome::Step;
use super::stiff_tree::StiffTree;
use super::workspace::Workspace;
use crate::model::lanes::LaneGroup;
use crate::model::residual::Term;

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
        if newton && let Some(step) = self.newton_step(terms, poses, damping) {
            self.retract(poses);
            let cost = self.trial_cost(terms);
            self.prefer(Attempt { step, cost }, &mut best, &mut winner);
            self.by_tree(terms, poses, step, &mut best, &mut winner);
        }
        (self.trial, self.step) = winner;
        best
    }

    /// The attempt to move positions and rotations apart, if it costs less than the given one, which is at the trial. Its poses then
    /// become the trial.
    ///
    /// `X Exp(d)` takes a pose along a screw. Where a long common motion `v` meets a bend of `w` radians between neighbours, their
    /// relative position then errs by `w v / 2`. With `X (I, v) Exp(0, r)` it errs by the square of the rotation `r`, however long the
    /// motion is: less on large maps, more for large rotations.
    pub(super) fn apart<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        first: Attempt,
    ) -> Option<Attempt> {
        let held = self.pattern.held;
        let mut other = poses.to_vec();
        for (pose, step) in other.iter_mut().skip(held).zip(&self.step) {
            *pose = moved_apart(pose, step);
        }
        std::mem::swap(&mut self.trial, &mut other);
        let cost = self.trial_cost(terms);
        if cost < first.cost || !first.cost.is_finite() {
            return Some(Attempt { cost, ..first });
        }
        self.trial = other;
        None
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

/// `X (I, v) Exp(0, r)` for the step `(v, r)`.
fn moved_apart<G: LieGroup<DOF>, const DOF: usize>(pose: &G, step: &SVector<f64, DOF>) -> G {
    let (mut along, mut about) = (*step, *step);
    along.rows_range_mut(translations(DOF)..).fill(0.0);
    about.rows_range_mut(..translations(DOF)).fill(0.0);
    pose.compose(&G::exp(&along)).compose(&G::exp(&about))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use posecut_geometry::SE2;

    /// Two neighbours move 50 m together and bend by 0.02 rad: the edge between them should change by what the linear model says.
    #[test]
    fn a_long_common_motion_with_a_small_bend_does_not_stretch_an_edge() {
        let poses = [SE2::new(3.0, 1.0, 0.4), SE2::new(4.0, 1.2, 0.9)];
        let common = nalgebra::Vector2::new(40.0, -30.0);
        let steps: Vec<Vector3<f64>> = poses
            .iter()
            .zip([0.01, 0.03])
            .map(|(pose, turn)| {
                let own = pose.rotation.inverse() * common;
                Vector3::new(own.x, own.y, turn)
            })
            .collect();
        let before = poses[0].between(&poses[1]);
        let expected = steps[1] - before.inverse().adjoint() * steps[0];
        let error = |moved: [SE2; 2]| (before.between(&moved[0].between(&moved[1])).log() - expected).amax();
        let apart = error([0, 1].map(|index| moved_apart(&poses[index], &steps[index])));
        let screw = error([0, 1].map(|index| poses[index].compose(&SE2::exp(&steps[index]))));
        assert!(apart < 1e-3, "{apart}");
        assert!(screw > 0.3, "{screw}");
    }
}

//! The second-order correction of a step: geodesic acceleration.
//!
//! A step `d` of the linear model leaves a curved valley by the second derivative of the residuals along it, `r''`. The correction
//! `a = -(H + damping D)^-1 J^T Omega r''` leads back, and `d + a / 2` follows the valley's floor to second order (M. K. Transtrum, J. P.
//! Sethna, "Improvements to the Levenberg-Marquardt algorithm for nonlinear least-squares minimization", 2012, equation 15). It takes
//! two substitutions with the step's own factor. Long drives of stiff edges are such valleys: without the correction the steps
//! there are so short that a descent takes hundreds.
//!
//! The curve through the poses depends on how a step moves them: `r''` belongs to that curve alone, so both ways are tried.

use nalgebra::SVector;
use posecut_geometry::LieGroup;

use super::contest::{Attempt, Winner, moved_apart};
use super::outcome::Step;
use super::phases::timed;
use super::stiff_tree::StiffTree;
use super::workspace::Workspace;
use crate::model::residual::Term;

/// Second derivatives are differences over this share of the step or, if that is more, this motion (shares of the graph's length,
/// radians).
const SHARE: f64 = 0.02;

impl<G: LieGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Tries the step, which is `self.step`, with its correction along the tree and with positions and rotations apart.
    pub(super) fn accelerate<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        step: Step,
        best: &mut Attempt,
        winner: &mut Winner<G, DOF>,
    ) {
        let Some(tree) = self.tree.take() else { return };
        let linear = self.step.clone();
        if !tree.is_empty() {
            self.try_corrected(terms, poses, step, Some(&tree), &linear);
            self.prefer_trial(terms, step, best, winner, &linear);
        }
        self.try_corrected(terms, poses, step, None, &linear);
        self.prefer_trial(terms, step, best, winner, &linear);
        self.tree = Some(tree);
    }

    /// Keeps the trial for the linear step if it costs less than the best so far.
    fn prefer_trial<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        step: Step,
        best: &mut Attempt,
        winner: &mut Winner<G, DOF>,
        linear: &[SVector<f64, DOF>],
    ) {
        self.step.copy_from_slice(linear);
        let cost = self.trial_cost(terms);
        self.prefer(Attempt { step, cost }, best, winner);
    }

    /// Sets the trial to the poses moved by `linear + a / 2`, along the tree if there is one.
    fn try_corrected<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        step: Step,
        tree: Option<&StiffTree>,
        linear: &[SVector<f64, DOF>],
    ) {
        let held = self.pattern.held;
        let share = SHARE / step.largest.max(1.0);
        let mut scaled = |share: f64| {
            for (step, linear) in self.step.iter_mut().zip(linear) {
                *step = linear * share;
            }
            let mut moved = Vec::new();
            move_poses(tree, poses, held, &self.step, &mut moved);
            moved
        };
        let (ahead, behind) = (scaled(share), scaled(-share));
        let Self { factor, pattern, step, phases, .. } = self;
        timed(&mut phases.linearisation, || {
            step.fill(SVector::zeros());
            for (term, slot) in terms.iter().zip(&pattern.slots) {
                let Some(bend) = term.bend(poses, &ahead, &behind, share) else { continue };
                if let Some(from) = slot.from {
                    step[from] -= bend.from;
                }
                if let Some(to) = slot.to {
                    step[to] -= bend.to;
                }
            }
        });
        timed(&mut phases.substitution, || factor.solve(&pattern.symbolic, step));
        for (step, linear) in step.iter_mut().zip(linear) {
            *step = linear + *step * 0.5;
        }
        move_poses(tree, poses, held, step, &mut self.trial);
    }
}

/// Moves the poses by the step: along the tree, or one by one with positions and rotations apart.
fn move_poses<G: LieGroup<DOF>, const DOF: usize>(
    tree: Option<&StiffTree>,
    poses: &[G],
    held: usize,
    step: &[SVector<f64, DOF>],
    moved: &mut Vec<G>,
) {
    if let Some(tree) = tree {
        tree.retract(poses, held, step, moved);
        return;
    }
    moved.clear();
    moved.extend_from_slice(poses);
    for (pose, step) in moved.iter_mut().skip(held).zip(step) {
        *pose = moved_apart(pose, step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::magnitude::Magnitude;
    use crate::model::problem::{Edge, EdgeKind};
    use crate::normal_equations::Pattern;
    use nalgebra::{Matrix3, Vector3};
    use posecut_cholesky::Memory;
    use posecut_geometry::SE2;

    /// A bent chain of rigid links with soft hinges whose last link is pulled aside. The linear step leaves an error of second order, the
    /// corrected one an error of third order: when the pull is halved, the cost that the step leaves falls to about 1/16 and 1/64.
    #[test]
    fn a_corrected_step_errs_by_one_order_less() {
        let nodes = 20;
        let link = SE2::new(1.0, 0.0, 0.1);
        let mut poses = vec![SE2::identity()];
        for node in 1..nodes {
            poses.push(poses[node - 1].compose(&link));
        }
        let left = |pull: f64| {
            let chain = Matrix3::from_diagonal(&Vector3::new(1e8, 1e8, 1.0));
            let mut edges: Vec<_> =
                (1..poses.len()).map(|to| Edge::new(to - 1, to, link, chain, EdgeKind::Odometry)).collect();
            let end = SE2::new(0.0, pull, 0.0).compose(&poses[poses.len() - 1]);
            let stiff = Matrix3::from_diagonal(&Vector3::new(1e4, 1e4, 1e-6));
            edges.push(Edge::new(0, poses.len() - 1, end, stiff, EdgeKind::Landmark));
            let pattern = Pattern::of(poses.len(), 1, &edges);
            let mut workspace = Workspace::new(&pattern, Magnitude::of(edges.iter()), Memory::default());
            let before = workspace.assemble(&edges, &poses);
            let step = workspace.solve(0.0, &mut None).expect("a connected graph");
            let promised = before - step.promised;
            let tree = StiffTree::new::<SE2, _, 3>(&edges, poses.len(), 1, 1.0);
            let linear = workspace.step.clone();
            tree.retract(&poses, 1, &linear, &mut workspace.trial);
            let uncorrected = workspace.trial_cost(&edges) - promised;
            workspace.try_corrected(&edges, &poses, step, Some(&tree), &linear);
            (uncorrected, workspace.trial_cost(&edges) - promised)
        };
        let (large, small) = (left(2.0), left(1.0));
        println!("{large:?} {small:?}");
        assert!(small.1 < 0.1 * small.0 && small.0 < large.0 / 12.0 && small.1 < large.1 / 40.0);
    }
}

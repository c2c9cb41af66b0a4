//! The second-order correction of a step along the stiff tree: geodesic acceleration.
//!
//! A step `d` of the linear model leaves a curved valley by the second derivative of the residuals along it, `r''`. The correction
//! `a = -(H + damping D)^-1 J^T Omega r''` leads back, and `d + a / 2` follows the valley's floor to second order (M. K. Transtrum, J. P.
//! Sethna, "Improvements to the Levenberg-Marquardt algorithm for nonlinear least-squares minimization", 2012). It takes one substitution with
//! the step's own factor. Long drives of stiff edges are such valleys: without the correction the steps there are so short that a descent
//! takes hundreds.
//!
//! Longer steps can end in another basin. So a step is only corrected where its motion fails pose by pose and the tree improves on that,
//! and only by a small correction; among many minima, as false landmark edges make them, descents mostly stay as they are.

use nalgebra::SVector;

use super::contest::{Attempt, Winner};
use super::outcome::Step;
use super::phases::timed;
use super::stiff_tree::StiffTree;
use super::workspace::Workspace;
use crate::model::lanes::LaneGroup;
use crate::model::term::Term;

/// Second derivatives are differences over this share of the step or, if that is more, this motion (shares of the graph's length,
/// radians).
const SHARE: f64 = 0.02;

/// The longest correction, `|a| / |d|` in the norm of `diag(H)`. A longer one lies beyond what two terms of the expansion describe;
/// without such a bound, which Transtrum and Sethna recommend, some descents end in a higher minimum.
const LONGEST: f64 = 0.375;

impl<G: LaneGroup<DOF>, const DOF: usize> Workspace<'_, G, DOF> {
    /// Tries the step, which is `self.step`, with its correction along the tree. The step stays the same.
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
        let is_short = self.correct(terms, poses, &tree, step, &linear);
        self.step.copy_from_slice(&linear);
        if is_short {
            let cost = self.trial_cost(terms);
            self.prefer(Attempt { step, cost }, best, winner);
        }
        self.tree = Some(tree);
    }

    /// Sets the trial to the poses moved along the tree by `linear + a / 2`; false if the correction is too long. Overwrites the step.
    fn correct<T: Term<G, DOF>>(
        &mut self,
        terms: &[T],
        poses: &[G],
        tree: &StiffTree,
        step: Step,
        linear: &[SVector<f64, DOF>],
    ) -> bool {
        let held = self.pattern.held;
        let share = SHARE / step.largest.max(1.0);
        let mut scaled = |share: f64| {
            for (step, linear) in self.step.iter_mut().zip(linear) {
                *step = linear * share;
            }
            let mut moved = Vec::new();
            tree.retract(poses, held, &self.step, &mut moved);
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
        timed(&mut phases.substitution, || factor.precondition(&pattern.symbolic, step));
        // Not <=: a length that is not a number is too long.
        if !(self.scaled_norm(&self.step) <= LONGEST * self.scaled_norm(linear)) {
            return false;
        }
        for (step, linear) in self.step.iter_mut().zip(linear) {
            *step = linear + *step * 0.5;
        }
        tree.retract(poses, held, &self.step, &mut self.trial);
        true
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
    use posecut_geometry::{LieGroup, SE2};

    /// A bent chain of rigid links with soft hinges whose last link is pulled aside: the costs that the linear and the corrected step leave
    /// beyond what the model promises, and whether the correction is short.
    fn left(pull: f64) -> (f64, f64, bool) {
        let link = SE2::new(1.0, 0.0, 0.1);
        let mut poses = vec![SE2::identity()];
        for node in 1..20 {
            poses.push(poses[node - 1].compose(&link));
        }
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
        let is_short = workspace.correct(&edges, &poses, &tree, step, &linear);
        (uncorrected, workspace.trial_cost(&edges) - promised, is_short)
    }

    /// The linear step leaves an error of second order, the corrected one an error of third order: when the pull is halved, the cost that
    /// the step leaves falls to about 1/16 and 1/64.
    #[test]
    fn a_corrected_step_errs_by_one_order_less() {
        let (large, small) = (left(2.0), left(1.0));
        println!("{large:?} {small:?}");
        assert!(large.2 && small.2);
        assert!(small.1 < 0.1 * small.0 && small.0 < large.0 / 12.0 && small.1 < large.1 / 40.0);
    }

    /// The correction grows with the square of the step.
    #[test]
    fn a_correction_that_is_long_beside_its_step_is_not_tried() {
        let pulls = [1.0, 4.0, 16.0, 64.0];
        let short = pulls.map(|pull| left(pull).2);
        println!("{short:?}");
        assert!(short[0] && !short[3]);
    }
}

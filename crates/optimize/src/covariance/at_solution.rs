//! A solution with its covariances.

use posecut_cholesky::Memory;

use super::marginals::Marginals;
use crate::batch::solution::Solution;
use crate::batch::solve::optimize_and_keep;
use crate::model::problem::Problem;
use crate::options::Options;
use crate::pose_group::PoseGroup;

/// [`optimize`](crate::optimize), and covariances at the result. The same as [`Marginals::new`] with the solution's poses and
/// weights, but the analysis of the pattern and the memory of the factor serve both.
///
/// `memory` is that of earlier marginals ([`Marginals::into_memory`]), if there are any.
pub fn optimize_with_marginals<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    options: &Options,
    memory: Vec<Memory>,
) -> (Solution<G>, Marginals<G, DOF>) {
    G::solve_with_marginals(problem, options, memory)
}

/// The body of [`optimize_with_marginals`].
pub(crate) fn solve_with_marginals<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    options: &Options,
    memory: Vec<Memory>,
) -> (Solution<G>, Marginals<G, DOF>) {
    let mut systems = Vec::new();
    let solution = optimize_and_keep(problem, options, memory, |system| systems.push(system));
    // An edge of weight zero is not part of the covariances' pattern, and a prior of weight zero fixes no gauge.
    let weights = solution.all_weights();
    if weights.iter().any(|&weight| weight <= 0.0) {
        systems.clear();
    }
    let marginals = Marginals::of(problem, &solution.poses, &weights, systems);
    (solution, marginals)
}

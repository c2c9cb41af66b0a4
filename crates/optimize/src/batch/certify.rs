//! The certificates of a graph's connected components.

use crate::certificate::Certificate;
use crate::model::gauge::count_held;
use crate::model::part::extract;
use crate::model::prior::PriorsOfNodes;
use crate::model::problem::Problem;
use crate::pose_group::PoseGroup;
use posecut_graph::connectivity::{Component, connected_components};

/// SE-Sync's dual certificate of every connected component. It is for SE-Sync's cost `F` (chordal, isotropic weights), not
/// for the cost of [`optimize`](crate::optimize): the poses are refined for `F` first. Kernels are ignored. A component with
/// several held nodes, or with priors, is a different problem that this certificate does not cover: its figures are NaN.
pub fn certify<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    poses: &[G],
) -> Vec<Certificate> {
    certify_and_refine(problem, poses).0
}

/// [`certify`], and the poses refined for `F`. A descent from them may find a lower cost than from the given poses, which then
/// were in another basin.
pub fn certify_and_refine<G: PoseGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    poses: &[G],
) -> (Vec<Certificate>, Vec<G>) {
    let ends = problem.edges().iter().map(|edge| (edge.from, edge.to));
    let solved = Problem::from_checked(poses.to_vec(), problem.edges().to_vec(), problem.held().to_vec());
    let priors = PriorsOfNodes::new(problem.priors());
    let mut local = vec![0; poses.len()];
    let mut refined = poses.to_vec();
    let mut certificate = |component: &Component| {
        if count_held(component, problem.held()) > 1 || priors.anchor(component) {
            return Certificate::NONE;
        }
        for (index, &node) in component.nodes.iter().enumerate() {
            local[node] = index;
        }
        let part = extract(&solved, component, &priors, &local);
        let (certificate, moved) = G::certificate(part.edges(), part.poses());
        for (&node, pose) in component.nodes.iter().zip(moved) {
            refined[node] = pose;
        }
        certificate
    };
    let certificates = connected_components(poses.len(), ends).iter().map(&mut certificate).collect();
    (certificates, refined)
}

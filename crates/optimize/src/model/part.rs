//! A connected component of a graph as a graph of its own.

use posecut_geometry::LieGroup;

use super::prior::{Prior, PriorsOfNodes};
use super::problem::{Edge, Problem};
use posecut_graph::connectivity::Component;

/// The component with its own numbering of nodes.
pub(crate) fn extract<G: LieGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    component: &Component,
    priors: &PriorsOfNodes,
    local: &[usize],
) -> Problem<G, DOF> {
    let poses = component.nodes.iter().map(|&node| problem.poses()[node]).collect();
    let held = component.nodes.iter().map(|&node| problem.held()[node]).collect();
    let renumber = |edge: &Edge<G, DOF>| Edge { from: local[edge.from], to: local[edge.to], ..*edge };
    let edges = component.edges.iter().map(|&edge| renumber(&problem.edges()[edge])).collect();
    let renumber = |prior: &Prior<G, DOF>| Prior { node: local[prior.node], ..*prior };
    let priors = priors.of_component(component).map(|prior| renumber(&problem.priors()[prior])).collect();
    Problem::from_checked(poses, edges, held).with_checked_priors(priors)
}

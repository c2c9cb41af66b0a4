//! A connected component of a graph as a graph of its own.

use posecut_geometry::LieGroup;

use super::problem::{Edge, Problem};
use posecut_graph::connectivity::Component;

/// The component with its own numbering of nodes.
pub(crate) fn extract<G: LieGroup<DOF>, const DOF: usize>(
    problem: &Problem<G, DOF>,
    component: &Component,
    local: &[usize],
) -> Problem<G, DOF> {
    let poses = component.nodes.iter().map(|&node| problem.poses()[node]).collect();
    let held = component.nodes.iter().map(|&node| problem.held()[node]).collect();
    let renumber = |edge: &Edge<G, DOF>| Edge { from: local[edge.from], to: local[edge.to], ..*edge };
    let edges = component.edges.iter().map(|&edge| renumber(&problem.edges()[edge])).collect();
    Problem::from_checked(poses, edges, held)
}

//! Benchmark graphs as sessions: each pose is followed by the edges that end at it.

use posecut_geometry::LieGroup;
use posecut_optimize::Edge;

/// For each node the edges whose later end it is, in the order of the file; odometry comes first.
pub(crate) fn by_later_end<G: LieGroup<DOF>, const DOF: usize>(
    nodes: usize,
    edges: &[Edge<G, DOF>],
) -> Vec<Vec<Edge<G, DOF>>> {
    let mut arrivals = vec![Vec::new(); nodes];
    for edge in edges {
        arrivals[edge.from.max(edge.to)].push(*edge);
    }
    for (node, edges) in arrivals.iter_mut().enumerate() {
        edges.sort_by_key(|edge| edge.from.min(edge.to) + 1 != node);
    }
    arrivals
}

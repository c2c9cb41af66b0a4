//! Connected components of a graph.

use posecut_graph::PoseGraph;
use posecut_graph::connectivity::{Component, connected_components};

/// The connected components over the edges in use, in the order of their first nodes, with indices of the graph's
/// nodes. An edge without a measurement fixes no pose, but counts here: it says that its nodes belong together.
pub fn parts(graph: &PoseGraph) -> Vec<Component> {
    let ends: Vec<_> =
        graph.edges.iter().filter(|edge| edge.in_use()).filter_map(|edge| graph.ends(edge)).collect();
    connected_components(graph.nodes.len(), ends.into_iter())
}

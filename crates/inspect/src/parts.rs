//! Parts of a graph that edges hold together.

use posecut_graph::PoseGraph;
use posecut_graph::connectivity::{Component, connected_components};

/// The parts that the edges in use hold together, in the order of their first nodes; indices are places in the graph's
/// nodes. An edge without a measurement holds nothing in place, but counts here: it says that its nodes belong together.
pub fn parts(graph: &PoseGraph) -> Vec<Component> {
    let ends: Vec<_> =
        graph.edges.iter().filter(|edge| edge.in_use()).filter_map(|edge| graph.ends(edge)).collect();
    connected_components(graph.nodes.len(), ends.into_iter())
}

//! The results of a multicut in a pose graph: rejected edges and numbered landmarks.

use std::collections::HashMap;

use posecut_graph::PoseGraph;

/// Whether the multicut separates the ends of an edge.
fn is_cut(graph: &PoseGraph, edge: usize, labels: &[u32]) -> bool {
    let label = |id| graph.node_index(id).map(|index| labels[index]);
    label(graph.edges[edge].from) != label(graph.edges[edge].to)
}

/// Writes costs and rejections; returns the number of landmark edges cut.
pub(crate) fn mark(graph: &mut PoseGraph, costs: &[(usize, f64)], labels: &[u32]) -> usize {
    let mut cut = 0;
    for (index, cost) in costs {
        let rejected = is_cut(graph, *index, labels);
        let edge = &mut graph.edges[*index];
        edge.cost = Some(*cost);
        if rejected {
            edge.reject("multicut");
            cut += 1;
        }
    }
    cut
}

/// Numbers the components that landmark edges connect, by their first node, and writes the numbers to their nodes. Returns
/// how many there are.
pub(crate) fn label_landmarks(graph: &mut PoseGraph, costs: &[(usize, f64)], labels: &[u32]) -> usize {
    let mut seen = vec![false; graph.nodes.len()];
    for (index, _) in costs {
        let edge = &graph.edges[*index];
        if edge.in_use() {
            for place in [edge.from, edge.to].into_iter().filter_map(|id| graph.node_index(id)) {
                seen[place] = true;
            }
        }
    }
    let mut numbers: HashMap<u32, u64> = HashMap::new();
    for (node, place) in graph.nodes.iter_mut().zip(0..) {
        let next = numbers.len() as u64;
        node.landmark = seen[place].then(|| *numbers.entry(labels[place]).or_insert(next));
    }
    numbers.len()
}

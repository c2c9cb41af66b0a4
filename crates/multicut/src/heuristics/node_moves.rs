//! Moves of single nodes: the cheapest local search.

use std::collections::VecDeque;

use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;

/// Gains below this share of a node's absolute costs are rounding errors.
const TOLERANCE: f64 = 1e-12;

/// Most visits per node, on average.
const VISITS: usize = 8;

/// Moves each node to the neighbouring cluster that attracts it most, or out of its cluster, while that gains. Visits a node
/// again when a neighbour has moved. Never worsens.
///
/// Linear in the arcs of the visited nodes.
pub(crate) fn move_nodes(graph: &SignedGraph, labels: &mut Vec<u32>, budget: &mut Budget) {
    let node_count = graph.node_count();
    // Labels above the largest one are free for nodes that leave. At most one label per node is in use at any time.
    let clusters = 2 * node_count + 1;
    let mut sizes = vec![0u32; clusters];
    for &label in labels.iter() {
        sizes[label as usize] += 1;
    }
    let mut free: Vec<u32> = (0..clusters as u32).rev().filter(|&label| sizes[label as usize] == 0).collect();
    let mut queue: VecDeque<u32> = graph.nodes().collect();
    let mut waiting = vec![true; node_count];
    let mut pull = vec![0.0; clusters];
    let mut visits = 0;
    let mut moved = false;
    while let Some(node) = queue.pop_front() {
        waiting[node as usize] = false;
        visits += 1;
        let arcs = graph.arcs(node);
        if visits > VISITS * node_count || !budget.spend(1 + arcs.len() as u64) {
            break;
        }
        let own = labels[node as usize];
        let mut magnitude = 0.0;
        for arc in arcs {
            pull[labels[arc.node as usize] as usize] += arc.cost;
            magnitude += arc.cost.abs();
        }
        let mut best = (pull[own as usize].max(0.0), None);
        if pull[own as usize] < -TOLERANCE * magnitude && sizes[own as usize] > 1 {
            best = (0.0, free.last().copied());
        }
        for arc in arcs {
            let label = labels[arc.node as usize];
            if pull[label as usize] > best.0 + TOLERANCE * magnitude && label != own {
                best = (pull[label as usize], Some(label));
            }
        }
        for arc in arcs {
            pull[labels[arc.node as usize] as usize] = 0.0;
        }
        let Some(to) = best.1 else { continue };
        moved = true;
        if free.last() == Some(&to) {
            free.pop();
        }
        sizes[own as usize] -= 1;
        if sizes[own as usize] == 0 {
            free.push(own);
        }
        sizes[to as usize] += 1;
        labels[node as usize] = to;
        for arc in arcs {
            if labels[arc.node as usize] != to && !std::mem::replace(&mut waiting[arc.node as usize], true) {
                queue.push_back(arc.node);
            }
        }
    }
    if moved {
        *labels = graph.connected_labels(labels);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(edges: &[(u32, u32, f64)], labels: &[u32]) -> Vec<u32> {
        let graph = SignedGraph::new(labels.len(), edges.iter().copied());
        let mut labels = labels.to_vec();
        move_nodes(&graph, &mut labels, &mut Budget::new(None, None));
        labels
    }

    #[test]
    fn a_node_goes_where_it_is_attracted_most() {
        assert_eq!(moved(&[(0, 1, 1.0), (1, 2, 2.0), (0, 2, -1.0)], &[0, 0, 1]), [0, 1, 1]);
    }

    #[test]
    fn a_node_that_is_repelled_leaves() {
        assert_eq!(moved(&[(0, 1, 2.0), (0, 2, -1.0), (1, 2, -1.0)], &[0, 0, 0]), [0, 0, 1]);
    }
}

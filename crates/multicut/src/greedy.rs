//! Greedy contraction: additive, and with fixation.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::budget::Budget;
use crate::signed_graph::SignedGraph;
use crate::union_find::UnionFind;

/// Orders positive floats as integers.
fn key(cost: f64) -> u64 {
    cost.to_bits()
}

/// A pair of clusters in a heap: the largest cost on top, then the smallest degrees and numbers.
type Entry = (u64, Reverse<((u32, u32), u32, u32)>);

fn entry(graph: &SignedGraph, tail: u32, head: u32, cost: f64) -> Entry {
    let (first, second) = (graph.arcs(tail).len() as u32, graph.arcs(head).len() as u32);
    (key(cost), Reverse(((first.min(second), first.max(second)), tail.min(head), tail.max(head))))
}

/// Greedy additive edge contraction (Keuper et al., ICCV 2015, algorithm 2, "GAEC"): joins the two clusters with
/// the largest total cost between them while that total is positive. Ties go to the pair with the smaller of its
/// degrees least, then the larger, then its numbers: nodes with few edges are the surest to join, and clusters grow
/// evenly.
///
/// A binary heap with outdated entries left in place; `O(m log m)` heap steps plus the merging of adjacency
/// vectors, smaller into larger.
pub(crate) fn additive_edge_contraction(mut graph: SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let mut joined = UnionFind::new(graph.node_count());
    let mut heap: BinaryHeap<_> = graph
        .edges()
        .filter(|&(_, _, cost)| cost > 0.0)
        .map(|(tail, head, cost)| entry(&graph, tail, head, cost))
        .collect();
    while let Some((cost, Reverse((_, tail, head)))) = heap.pop() {
        let current = graph.cost(tail, head);
        if current <= 0.0 || key(current) != cost {
            continue;
        }
        let (kept, gone, arcs) = graph.contract(tail, head);
        joined.union(kept, gone);
        for arc in &arcs {
            let cost = graph.cost(kept, arc.node);
            if cost > 0.0 {
                heap.push(entry(&graph, kept, arc.node, cost));
            }
        }
        if !budget.spend(1 + arcs.len() as u64) {
            break;
        }
    }
    joined.labels()
}

/// Greedy fixation (Levinkov, Kirillov, Andres, GCPR 2017): decides the pair of clusters with the largest absolute
/// cost between them, attractive pairs by joining them, repulsive ones by keeping them apart for good.
///
/// Costs as much as [`additive_edge_contraction`], with every edge in the heap.
pub(crate) fn greedy_fixation(mut graph: SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let mut joined = UnionFind::new(graph.node_count());
    // No sum with this cost is ever positive: what carries it stays apart.
    let apart = -2.0 * (1.0 + graph.edges().map(|(_, _, cost)| cost.abs()).sum::<f64>());
    let mut heap: BinaryHeap<_> =
        graph.edges().map(|(tail, head, cost)| entry(&graph, tail, head, cost.abs())).collect();
    while let Some((cost, Reverse((_, tail, head)))) = heap.pop() {
        let current = graph.cost(tail, head);
        if current == 0.0 || key(current.abs()) != cost {
            continue;
        }
        if !budget.spend(1) {
            break;
        }
        if current < 0.0 {
            if current > apart / 2.0 {
                graph.add_cost(tail, head, apart);
            }
            continue;
        }
        let (kept, gone, arcs) = graph.contract(tail, head);
        joined.union(kept, gone);
        budget.spend(arcs.len() as u64);
        for arc in &arcs {
            let cost = graph.cost(kept, arc.node);
            if cost > apart / 2.0 && cost != 0.0 {
                heap.push(entry(&graph, kept, arc.node, cost.abs()));
            }
        }
    }
    joined.labels()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_the_largest_cost_first() {
        let list = [(0, 1, 2.0), (1, 2, 3.0), (0, 2, -4.0)];
        let graph = SignedGraph::new(3, list.into_iter());
        let labels = additive_edge_contraction(graph, &mut Budget::new(None, None));
        assert_eq!(labels, [0, 1, 1]);
    }

    #[test]
    fn ties_go_to_the_pair_with_the_fewest_edges() {
        // A path 2 - 0 - 1 - 3, all tied: its ends join their neighbours before the middle joins.
        let list = [(0, 2, 1.0), (0, 1, 1.0), (1, 3, 1.0), (0, 4, -1.0), (1, 4, -1.0), (2, 3, -1.5)];
        let graph = SignedGraph::new(5, list.into_iter());
        let labels = additive_edge_contraction(graph, &mut Budget::new(None, None));
        assert_eq!(labels, [0, 1, 0, 1, 2]);
    }

    #[test]
    fn fixation_keeps_what_repels_most_apart() {
        // Contraction joins all four for 0; fixation decides on the repulsive edge first.
        let list = [(0, 3, -6.0), (0, 1, 5.0), (0, 2, 5.0), (1, 3, 4.0), (2, 3, 4.0)];
        let graph = SignedGraph::new(4, list.into_iter());
        let budget = &mut Budget::new(None, None);
        assert_eq!(additive_edge_contraction(graph.clone(), budget), [0, 0, 0, 0]);
        assert_eq!(greedy_fixation(graph, budget), [0, 0, 0, 1]);
    }
}

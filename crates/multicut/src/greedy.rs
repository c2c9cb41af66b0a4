//! Greedy additive edge contraction.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::budget::Budget;
use crate::signed_graph::SignedGraph;
use crate::union_find::UnionFind;

/// Orders positive floats as integers.
fn key(cost: f64) -> u64 {
    cost.to_bits()
}

/// Greedy additive edge contraction (Keuper et al., ICCV 2015, algorithm 2, "GAEC"): joins the two clusters with
/// the largest total cost between them while that total is positive. Ties go to the pair whose smaller, then
/// larger number is least.
///
/// A binary heap with outdated entries left in place; `O(m log m)` heap steps plus the merging of adjacency
/// vectors, smaller into larger.
pub(crate) fn additive_edge_contraction(mut graph: SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let mut joined = UnionFind::new(graph.node_count());
    let entry = |graph: &SignedGraph, tail: u32, head: u32, cost: f64| {
        let degrees = (graph.arcs(tail).len() as u32, graph.arcs(head).len() as u32);
        let degrees = (degrees.0.min(degrees.1), degrees.0.max(degrees.1));
        (key(cost), Reverse((degrees, tail.min(head), tail.max(head))))
    };
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
}

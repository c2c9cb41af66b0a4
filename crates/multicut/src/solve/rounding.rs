//! Solutions from points of the relaxation.

use super::search::State;
use crate::bound::relaxation::Relaxation;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;
use crate::heuristics::greedy::{Preference, additive_edge_contraction};
use crate::heuristics::kernighan_lin::kernighan_lin_with_joins;

/// Rounds a fractional point to solutions.
pub(super) fn round(
    graph: &SignedGraph,
    kernel: &Kernel,
    relaxation: &Relaxation,
    state: &mut State,
    budget: &mut Budget,
) {
    if budget.is_over() {
        return;
    }
    // If the relaxation is integral, its multicut is the optimum.
    let mut uncut = UnionFind::new(graph.node_count());
    for (edge, &(tail, head)) in kernel.ends.iter().enumerate() {
        if kernel.costs[edge] > 0.0 && relaxation.paid[edge] < 0.5 {
            uncut.union(tail, head);
        }
    }
    state.offer(graph, uncut.labels());
    state.offer(graph, rounded_solution(graph, kernel, &relaxation.paid, budget));
}

/// Rounds a fractional point: contracts by costs that are scaled down for edges that the point cuts more, then Kernighan-Lin.
pub(super) fn rounded_solution(
    graph: &SignedGraph,
    kernel: &Kernel,
    paid: &[f64],
    budget: &mut Budget,
) -> Vec<u32> {
    let scaled = kernel
        .ends
        .iter()
        .zip(&kernel.costs)
        .zip(paid)
        .map(|((&(tail, head), &cost), &paid)| (tail, head, cost * (1.0 - paid.clamp(0.0, 1.0) + 1e-3)));
    let scaled = SignedGraph::new(graph.node_count(), scaled);
    let mut labels = additive_edge_contraction(&scaled, Preference::Degree, budget);
    kernighan_lin_with_joins(graph, &mut labels, budget);
    labels
}

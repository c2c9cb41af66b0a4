//! Edges fixed by their residual cost.

use crate::bound::packing::Packing;
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;

/// A graph in which the ends of some edges are joined by a reward.
pub(super) struct Fixed {
    pub(super) graph: SignedGraph,
    /// The edges whose ends are joined.
    pub(super) edges: Vec<(u32, u32)>,
    /// Number of nodes saved.
    pub(super) nodes: usize,
    /// Lower bound on every solution that the fixed edges exclude.
    pub(super) left_out: f64,
}

/// Joins the ends of attractive edges if cutting the edge alone would lift the bound to the goal. `big` is more than all costs
/// together. `None` if there is no such edge.
pub(super) fn fix(
    graph: &SignedGraph,
    kernel: &Kernel,
    packing: &Packing,
    goal: f64,
    big: f64,
) -> Option<Fixed> {
    let mut fixed = Fixed { graph: graph.clone(), edges: Vec::new(), nodes: 0, left_out: f64::INFINITY };
    let mut sets = UnionFind::new(graph.node_count());
    for (edge, &(tail, head)) in kernel.ends.iter().enumerate() {
        let without = kernel.rounded(packing.bound + packing.residual[edge]);
        if kernel.costs[edge] > 0.0 && without >= goal {
            fixed.left_out = fixed.left_out.min(without);
            // A big cost forces the join: dominance contracts the edge at once, and nodes keep their numbers.
            if sets.union(tail, head) {
                fixed.graph.add_cost(tail, head, big);
                fixed.edges.push((tail, head));
                fixed.nodes += 1;
            }
        }
    }
    (fixed.nodes > 0).then_some(fixed)
}

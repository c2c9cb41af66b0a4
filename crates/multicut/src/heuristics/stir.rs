//! Local search from disturbed solutions.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::kernighan_lin::kernighan_lin_with_joins;
use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;

/// Shares of the nodes that are disturbed, used in turn.
const SHARES: [f64; 4] = [0.05, 0.15, 0.3, 0.1];

/// Improves `labels` by moving random nodes, each to the cluster of a random neighbour or to a cluster of its own, and
/// Kernighan-Lin with joins from there (iterated local search; Lourenco, Martin, Stuetzle 2003). Takes what is no worse. Ends
/// when `effort` is spent. Never worsens.
pub(crate) fn stir(graph: &SignedGraph, labels: &mut Vec<u32>, effort: u64, seed: u64, budget: &mut Budget) {
    let nodes = graph.node_count();
    if nodes == 0 {
        return;
    }
    let end = budget.spent().saturating_add(effort);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut objective = graph.objective(labels);
    let mut round = 0;
    while budget.spent() < end && budget.spend(nodes as u64) {
        let count = ((SHARES[round % SHARES.len()] * nodes as f64) as usize).max(2);
        round += 1;
        let mut other = labels.clone();
        let mut fresh = other.iter().max().map_or(0, |&label| label + 1);
        for _ in 0..count {
            let node = random.random_range(0..nodes);
            let arcs = graph.arcs(node as u32);
            let choice = random.random_range(0..=arcs.len());
            other[node] = if let Some(arc) = arcs.get(choice) {
                other[arc.node as usize]
            } else {
                fresh += 1;
                fresh - 1
            };
        }
        let mut other = graph.connected_labels(&other);
        kernighan_lin_with_joins(graph, &mut other, budget);
        let value = graph.objective(&other);
        if value <= objective {
            (objective, *labels) = (value, other);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heuristics::greedy::{Preference, additive_edge_contraction};

    #[test]
    fn stirring_never_worsens_and_finds_what_contraction_misses() {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let mut better = 0;
        for seed in 0..20 {
            let pairs = (0..25u32).flat_map(|u| (0..u).map(move |v| (u, v)));
            let edges: Vec<_> = pairs.map(|(u, v)| (u, v, random.random_range(-1.0..1.0))).collect();
            let graph = SignedGraph::new(25, edges.into_iter());
            let budget = &mut Budget::new(None, None);
            let mut labels = additive_edge_contraction(&graph, Preference::Degree, budget);
            let before = graph.objective(&labels);
            stir(&graph, &mut labels, 100_000, seed, budget);
            let after = graph.objective(&labels);
            assert!(after <= before);
            better += u32::from(after < before - 1e-9);
        }
        assert!(better >= 15, "{better}");
    }
}

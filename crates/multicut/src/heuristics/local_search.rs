//! Fusion moves: local search from the results of heuristics.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::greedy::{Preference, additive_edge_contraction, greedy_fixation};
use super::kernighan_lin::kernighan_lin_with_joins;
use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;
use crate::reduce::decomposition::decompose;

/// Amplitudes of the noise on costs, used in turn.
const NOISE: [f64; 4] = [0.3, 1.0, 0.1, 0.6];

/// Improves `labels` by `rounds` fusion moves (Beier, Hamprecht, Kappes, CVPR 2015). A proposal comes from greedy contraction
/// or fixation with noisy costs, and Kernighan-Lin. A good combination of proposal and incumbent follows by contracting the
/// edges that both join, reducing, and solving the small rest heuristically. Never worsens.
pub(crate) fn fuse_proposals(
    graph: &SignedGraph,
    labels: &mut Vec<u32>,
    rounds: usize,
    seed: u64,
    budget: &mut Budget,
) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut objective = graph.objective(labels);
    for round in 0..rounds {
        if !budget.spend(graph.node_count() as u64) {
            return;
        }
        let noise = NOISE[round % NOISE.len()];
        let noisy: Vec<(u32, u32, f64)> = graph
            .edges()
            .map(|(tail, head, cost)| (tail, head, cost * (1.0 + noise * random.random_range(-1.0..1.0))))
            .collect();
        let noisy = SignedGraph::new(graph.node_count(), noisy.into_iter());
        // Every other proposal comes from fixation, which considers repulsion first.
        let mut proposal = if round % 2 == 0 {
            additive_edge_contraction(&noisy, Preference::Degree, budget)
        } else {
            greedy_fixation(&noisy, budget)
        };
        kernighan_lin_with_joins(graph, &mut proposal, budget);
        if budget.is_over() {
            return;
        }
        let fused = fuse(graph, labels, &proposal, kernighan_lin_with_joins, budget);
        for candidate in [proposal, fused] {
            let value = graph.objective(&candidate);
            if value < objective {
                objective = value;
                *labels = candidate;
            }
        }
    }
}

/// A good combination of two labellings: nodes joined in both stay joined.
pub(crate) fn fuse(
    graph: &SignedGraph,
    first: &[u32],
    second: &[u32],
    polish: Polish,
    budget: &mut Budget,
) -> Vec<u32> {
    let together = |labels: &[u32], tail: u32, head: u32| labels[tail as usize] == labels[head as usize];
    let keep = |tail, head| together(first, tail, head) && together(second, tail, head);
    solve_contracted(graph, keep, polish, budget)
}

/// A function that improves a labelling: Kernighan-Lin with joins, or moves of single nodes.
pub(crate) type Polish = fn(&SignedGraph, &mut Vec<u32>, &mut Budget);

/// A good labelling that joins the ends of the edges for which `keep` holds. The contracted graph is reduced, its kernels are
/// contracted greedily and polished, and at last the whole labelling is polished.
pub(crate) fn solve_contracted(
    graph: &SignedGraph,
    keep: impl Fn(u32, u32) -> bool,
    polish: Polish,
    budget: &mut Budget,
) -> Vec<u32> {
    let mut sets = UnionFind::new(graph.node_count());
    for (tail, head, _) in graph.edges() {
        if keep(tail, head) {
            sets.union(tail, head);
        }
    }
    let classes = sets.labels();
    let count = classes.iter().max().map_or(0, |&class| class as usize + 1);
    let quotient: Vec<(u32, u32, f64)> = graph
        .edges()
        .map(|(tail, head, cost)| (classes[tail as usize], classes[head as usize], cost))
        .filter(|(tail, head, _)| tail != head)
        .collect();
    let decomposition = decompose(SignedGraph::new(count, quotient.into_iter()), false, budget);
    let solved: Vec<Vec<u32>> = decomposition
        .kernels
        .iter()
        .map(|piece| {
            let mut labels = additive_edge_contraction(&piece.graph, Preference::Degree, budget);
            polish(&piece.graph, &mut labels, budget);
            labels
        })
        .collect();
    let joined = decomposition.assemble(solved.iter().map(Vec::as_slice));
    let mut labels: Vec<u32> = classes.iter().map(|&class| joined[class as usize]).collect();
    polish(graph, &mut labels, budget);
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fusion_takes_the_better_half_of_each() {
        // Two conflicted triangles with a weak edge between them; each labelling solves one of them.
        let triangle = |at: u32| [(at, at + 1, 2.0), (at + 1, at + 2, 1.0), (at, at + 2, -3.0)];
        let edges: Vec<_> = triangle(0).into_iter().chain(triangle(3)).chain([(2, 3, 0.1)]).collect();
        let graph = SignedGraph::new(6, edges.into_iter());
        let budget = &mut Budget::new(None, None);
        let fused = fuse(&graph, &[0, 0, 1, 2, 2, 2], &[0, 0, 0, 2, 2, 3], kernighan_lin_with_joins, budget);
        assert!((graph.objective(&fused) - -4.0).abs() < 1e-12, "{fused:?}");
    }
}

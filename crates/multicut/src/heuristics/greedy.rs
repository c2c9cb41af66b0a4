//! Greedy contraction: additive edge contraction and greedy fixation.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::bisection::bisect;
use super::contraction_queue::ContractionQueue;
use super::node_moves::move_nodes;
use crate::budget::Budget;
use crate::graph::cluster_graph::ClusterGraph;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;

/// Which pair of clusters [`additive_edge_contraction`] joins next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Preference {
    /// The largest cost; among ties, the pair whose smaller degree is smallest. Joining nodes with few edges is the safest
    /// choice, and clusters grow evenly.
    Degree,
    /// The largest cost; among ties, the pair that has waited longest.
    Age,
    /// The largest cost per node of both clusters. It splits bands into even stretches, where cost alone would let one
    /// cluster swallow all others.
    Balance,
}

/// Rounds a positive number down to one of four values in each power of two, so that clusters that grew a little keep their
/// position in the queue.
fn coarse(value: f64) -> f64 {
    f64::from_bits(value.to_bits() & (u64::MAX << 50))
}

/// All numbers below `count`, each far from the previous one (by the golden section). Nodes are numbered along bands, so if
/// ties were taken in that order, one cluster would grow from one end of a band to the other.
fn scattered(count: usize) -> impl Iterator<Item = u32> {
    let coprime = |step: usize| {
        let (mut a, mut b) = (step, count);
        while b > 0 {
            (a, b) = (b, a % b);
        }
        a == 1
    };
    let golden = (count as f64 * 0.618_033_988_749_894_8) as usize;
    // Among `count` consecutive numbers, one is coprime to `count`.
    let step = (golden.max(1)..=golden + count).find(|&step| coprime(step)).unwrap_or(1);
    (0..count).map(move |index| (index * step % count) as u32)
}

/// Greedy additive edge contraction (Keuper et al., ICCV 2015, algorithm 2, "GAEC"): joins two clusters with a positive total
/// cost between them, until no such pair remains.
///
/// Outdated entries stay in the queue. Takes `O(m log m)` steps of the queue, plus merging of adjacency vectors, smaller into
/// larger.
pub(crate) fn additive_edge_contraction(
    graph: &SignedGraph,
    preference: Preference,
    budget: &mut Budget,
) -> Vec<u32> {
    let node_count = graph.node_count();
    let mut joined = UnionFind::new(node_count);
    if !budget.spend(node_count as u64) {
        return joined.labels();
    }
    let mut sizes = vec![1u32; if preference == Preference::Balance { node_count } else { 0 }];
    // Rounded balances take few values, too.
    let few = preference == Preference::Balance || graph.edges().all(|edge| edge.2.fract() == 0.0);
    let mut queue = ContractionQueue::new(few);
    let mut clusters = ClusterGraph::new(graph);
    let priority = |clusters: &ClusterGraph, sizes: &[u32], tail: u32, head: u32, cost: f64| match preference
    {
        Preference::Degree => {
            let degree = clusters.degree(tail).min(clusters.degree(head));
            (cost, u32::MAX - degree as u32)
        }
        Preference::Age => (cost, 0),
        Preference::Balance => (coarse(cost / f64::from(sizes[tail as usize] + sizes[head as usize])), 0),
    };
    for tail in scattered(node_count) {
        for arc in graph.arcs(tail).iter().filter(|arc| arc.node > tail && arc.cost > 0.0) {
            queue.push(priority(&clusters, &sizes, tail, arc.node, arc.cost), tail, arc.node);
        }
    }
    while let Some(((stated, _), tail, head)) = queue.pop() {
        let cost = clusters.cost(tail, head);
        let now = priority(&clusters, &sizes, tail, head, cost);
        if cost <= 0.0 || now.0 > stated {
            continue;
        }
        if now.0 < stated {
            // When a cost falls, a new entry is pushed, but not when only the clusters grow. Push that entry here.
            if preference == Preference::Balance {
                queue.push(now, tail, head);
            }
            continue;
        }
        let (kept, gone, arcs) = clusters.contract(tail, head);
        joined.union(kept, gone);
        if preference == Preference::Balance {
            sizes[kept as usize] += sizes[gone as usize];
        }
        for arc in &arcs {
            if arc.cost > 0.0 {
                queue.push(priority(&clusters, &sizes, kept, arc.node, arc.cost), kept, arc.node);
            }
        }
        if !budget.spend(1 + arcs.len() as u64) {
            break;
        }
    }
    joined.labels()
}

/// Number of edges above which [`contractions`] also bisects; in shorter graphs contraction is as good.
const LONG: usize = 10_000;

/// Several labellings, each improved by moves of single nodes, the best first: joining everything, [`bisect`] in larger
/// graphs, and [`additive_edge_contraction`] with each preference.
pub(crate) fn contractions(
    graph: &SignedGraph,
    preferences: &[Preference],
    budget: &mut Budget,
) -> Vec<Vec<u32>> {
    let mut found = vec![(0.0, vec![0; graph.node_count()])];
    if graph.edges().count() > LONG {
        let mut labels = bisect(graph, budget);
        move_nodes(graph, &mut labels, budget);
        found.push((graph.objective(&labels), labels));
    }
    for &preference in preferences {
        if budget.is_over() {
            break;
        }
        let mut labels = additive_edge_contraction(graph, preference, budget);
        move_nodes(graph, &mut labels, budget);
        found.push((graph.objective(&labels), labels));
    }
    // The sort is stable: among equals the earlier labelling wins.
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|entry| entry.1).collect()
}

/// Orders positive floats as integers.
fn key(cost: f64) -> u64 {
    cost.to_bits()
}

/// A pair of clusters in a heap: the largest cost first, then the smallest degrees and numbers.
type Entry = (u64, Reverse<((u32, u32), u32, u32)>);

fn entry(clusters: &ClusterGraph, tail: u32, head: u32, cost: f64) -> Entry {
    let (first, second) = (clusters.degree(tail) as u32, clusters.degree(head) as u32);
    (key(cost), Reverse(((first.min(second), first.max(second)), tail.min(head), tail.max(head))))
}

/// Greedy fixation (Levinkov, Kirillov, Andres, GCPR 2017): repeatedly decides the pair of clusters with the largest absolute
/// cost between them. It joins attractive pairs, and keeps repulsive pairs apart for good.
///
/// Takes as long as [`additive_edge_contraction`], with every edge in the heap.
pub(crate) fn greedy_fixation(graph: &SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let mut joined = UnionFind::new(graph.node_count());
    let mut clusters = ClusterGraph::new(graph);
    // No sum that includes this cost is ever positive, so such pairs stay apart.
    let apart = -2.0 * (1.0 + graph.edges().map(|(_, _, cost)| cost.abs()).sum::<f64>());
    let mut heap: BinaryHeap<_> =
        graph.edges().map(|(tail, head, cost)| entry(&clusters, tail, head, cost.abs())).collect();
    while let Some((cost, Reverse((_, tail, head)))) = heap.pop() {
        let current = clusters.cost(tail, head);
        if current == 0.0 || key(current.abs()) != cost {
            continue;
        }
        if !budget.spend(1) {
            break;
        }
        if current < 0.0 {
            if current > apart / 2.0 {
                clusters.add_cost(tail, head, apart);
            }
            continue;
        }
        let (kept, gone, arcs) = clusters.contract(tail, head);
        joined.union(kept, gone);
        budget.spend(arcs.len() as u64);
        for arc in &arcs {
            if arc.cost > apart / 2.0 && arc.cost != 0.0 {
                heap.push(entry(&clusters, kept, arc.node, arc.cost.abs()));
            }
        }
    }
    joined.labels()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scattered_order_leaves_nothing_out() {
        for count in [0, 1, 2, 3, 8, 55, 1000] {
            let mut order: Vec<u32> = scattered(count).collect();
            assert!(count < 8 || order.windows(2).all(|pair| pair[0].abs_diff(pair[1]) > 1));
            order.sort_unstable();
            assert!(order.into_iter().eq(0..count as u32));
        }
    }

    #[test]
    fn takes_the_largest_cost_first() {
        let list = [(0, 1, 2.0), (1, 2, 3.0), (0, 2, -4.0)];
        let graph = SignedGraph::new(3, list.into_iter());
        let labels = additive_edge_contraction(&graph, Preference::Degree, &mut Budget::new(None, None));
        assert_eq!(labels, [0, 1, 1]);
    }

    #[test]
    fn ties_go_to_the_pair_with_the_fewest_edges() {
        // A path 2 - 0 - 1 - 3 with equal costs: the ends join their neighbours before the middle joins.
        let list = [(0, 2, 1.0), (0, 1, 1.0), (1, 3, 1.0), (0, 4, -1.0), (1, 4, -1.0), (2, 3, -1.5)];
        let graph = SignedGraph::new(5, list.into_iter());
        let labels = additive_edge_contraction(&graph, Preference::Degree, &mut Budget::new(None, None));
        assert_eq!(labels, [0, 1, 0, 1, 2]);
    }

    #[test]
    fn fixation_keeps_what_repels_most_apart() {
        // Contraction joins all four for 0; fixation decides on the repulsive edge first.
        let list = [(0, 3, -6.0), (0, 1, 5.0), (0, 2, 5.0), (1, 3, 4.0), (2, 3, 4.0)];
        let graph = SignedGraph::new(4, list.into_iter());
        let budget = &mut Budget::new(None, None);
        assert_eq!(additive_edge_contraction(&graph, Preference::Degree, budget), [0, 0, 0, 0]);
        assert_eq!(greedy_fixation(&graph, budget), [0, 0, 0, 1]);
    }
}

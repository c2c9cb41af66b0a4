//! The best cut of a sequence of nodes into consecutive segments.

use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;

/// Labels of the segments of a sequence that contains every node once, with the least objective of all choices of segments.
///
/// The objective is the sum of all costs minus the sum over edges inside a segment. So with `S(i, j)`, the sum over edges
/// with both ends at positions `i ... j - 1`, the best sum is `g(j) = max over i < j of g(i) + S(i, j)`, `g(0) = 0`. When `j`
/// grows by one, an edge whose later end is `j` adds its cost to `g(i) + S(i, j)` for every `i` up to its earlier end.
/// [`Prefixes`] keeps these sums.
///
/// In a band, which results when one session follows another, a segment's end is a full break, and full breaks are nearly all
/// that an optimum cuts. Clusters of the result are connected. `O((n + m) log n)`.
pub(crate) fn segment(graph: &SignedGraph, order: &[u32], budget: &mut Budget) -> Vec<u32> {
    let nodes = order.len();
    let edges = graph.edges().count();
    let depth = nodes.max(2).ilog2() as usize + 1;
    // A step of the tree is cheaper than a visited edge, whose memory is not in a cache.
    if nodes == 0 || !budget.affords((nodes + edges * depth / 4) as u64) {
        return vec![0; nodes];
    }
    budget.spend((nodes + edges * depth / 4) as u64);
    let mut position = vec![0u32; nodes];
    for (at, &node) in order.iter().enumerate() {
        position[node as usize] = at as u32;
    }
    let mut sums = Prefixes::new(nodes);
    // For each end of a segment its best start.
    let mut start = vec![0u32; nodes + 1];
    let mut before = 0.0;
    for (at, &node) in order.iter().enumerate() {
        sums.add(at, before, false);
        for arc in graph.arcs(node) {
            let other = position[arc.node as usize] as usize;
            if other < at {
                sums.add(other, arc.cost, true);
            }
        }
        let (first, best) = sums.best();
        start[at + 1] = first as u32;
        before = best;
    }
    let mut labels = vec![0; nodes];
    let (mut end, mut label) = (nodes, 0);
    while end > 0 {
        let first = start[end] as usize;
        for &node in &order[first..end] {
            labels[node as usize] = label;
        }
        label += 1;
        end = first;
    }
    graph.connected_labels(&labels)
}

/// Values at positions, all 0 at first, under addition to a prefix and the search for the largest. A binary tree over the
/// positions holds for each of its ranges the sum of *steps* (a step is added to its own and all earlier positions) and the
/// largest sum of a suffix, so one addition changes one path to the root.
struct Prefixes {
    /// Number of leaves, a power of two; node `k` has the children `2 k` and `2 k + 1`, and leaves follow from `leaves` on.
    leaves: usize,
    sum: Vec<f64>,
    largest: Vec<f64>,
}

impl Prefixes {
    /// Values of positions that were never added to alone count as minus infinity.
    fn new(positions: usize) -> Self {
        let leaves = positions.next_power_of_two();
        Self { leaves, sum: vec![0.0; 2 * leaves], largest: vec![f64::NEG_INFINITY; 2 * leaves] }
    }

    /// Adds to the value of one position, or of all positions up to it.
    fn add(&mut self, position: usize, value: f64, prefix: bool) {
        let mut node = position + self.leaves;
        if prefix {
            self.sum[node] += value;
            self.largest[node] += value;
        } else {
            // The leaf's own value differs from its step.
            self.largest[node] =
                if self.largest[node] == f64::NEG_INFINITY { value } else { self.largest[node] + value };
        }
        while node > 1 {
            node /= 2;
            let (left, right) = (2 * node, 2 * node + 1);
            self.sum[node] = self.sum[left] + self.sum[right];
            self.largest[node] = self.largest[right].max(self.largest[left] + self.sum[right]);
        }
    }

    /// The position with the largest value, the last among equals, and the value.
    fn best(&self) -> (usize, f64) {
        let mut node = 1;
        while node < self.leaves {
            let (left, right) = (2 * node, 2 * node + 1);
            node = if self.largest[right] >= self.largest[left] + self.sum[right] { right } else { left };
        }
        (node - self.leaves, self.largest[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn no_choice_of_segments_is_better() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        for _ in 0..300 {
            let nodes = random.random_range(1..=9u32);
            let edges: Vec<(u32, u32, f64)> = (0..nodes)
                .flat_map(|tail| (tail + 1..nodes).map(move |head| (tail, head)))
                .map(|(tail, head)| (tail, head, f64::from(random.random_range(-3..=3))))
                .collect();
            let graph = SignedGraph::new(nodes as usize, edges.into_iter());
            let mut order: Vec<u32> = graph.nodes().collect();
            for last in (1..order.len()).rev() {
                order.swap(last, random.random_range(0..=last));
            }
            let best = (0..1u32 << (nodes - 1))
                .map(|breaks| {
                    let mut labels = vec![0; nodes as usize];
                    for (at, &node) in order.iter().enumerate() {
                        labels[node as usize] = (breaks & ((1 << at) - 1)).count_ones();
                    }
                    graph.objective(&labels)
                })
                .fold(f64::INFINITY, f64::min);
            let labels = segment(&graph, &order, &mut Budget::new(None, None));
            assert_eq!(graph.objective(&labels), best, "{graph:?} {order:?}");
        }
    }
}

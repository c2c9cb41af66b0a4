//! Nodes joined because the capacity that a packing leaves connects them too well to be cut apart.

use std::collections::BinaryHeap;

use crate::bound::packing::Packing;
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;

/// Edges whose ends every better solution joins.
pub(super) struct Fixed {
    /// The edges whose ends are joined. Each follows from the packing and the edges before it.
    pub(super) edges: Vec<(u32, u32)>,
    /// Lower bound on every solution that the fixed edges exclude.
    pub(super) left_out: f64,
}

impl Fixed {
    /// The graph in which a reward joins these ends. `big` is more than all costs together: dominance contracts the edges at once, and
    /// nodes keep their numbers.
    pub(super) fn rewarded(&self, graph: &SignedGraph, big: f64) -> SignedGraph {
        let mut graph = graph.clone();
        for &(tail, head) in &self.edges {
            graph.add_cost(tail, head, big);
        }
        graph
    }
}

/// Joins the ends of attractive edges if cutting the ends apart would lift the bound to the goal. The number of edges is
/// the number of nodes saved.
///
/// A multicut that separates two nodes cuts all paths between them. So it pays at least the bound and the least cut between them, with
/// the residual of attractive edges as capacities. Once nodes are joined, they count as one. [`scan`] finds pairs with large cuts
/// between them without computing the cuts. `O(m log m)` a scan, and few scans.
pub(super) fn fix(kernel: &Kernel, packing: &Packing, goal: f64) -> Fixed {
    let mut fixed = Fixed { edges: Vec::new(), left_out: f64::INFINITY };
    let mut sets = UnionFind::new(kernel.node_count());
    loop {
        let before = fixed.edges.len();
        scan(kernel, packing, &mut sets, |edge, cut, sets| {
            let without = kernel.rounded(packing.bound + cut);
            let (tail, head) = kernel.ends[edge as usize];
            if without >= goal && sets.union(tail, head) {
                fixed.left_out = fixed.left_out.min(without);
                fixed.edges.push((tail, head));
            }
        });
        if fixed.edges.len() == before {
            return fixed;
        }
    }
}

/// Visits each attractive edge between two sets once, with a lower bound on the least cut between its ends, in the residual of
/// attractive edges with each set as one node.
///
/// Sets are visited in the order of their capacity to those visited before (maximum adjacency). When the edges of a set are followed, the
/// capacity that another set has received so far, this edge included, is at most the least cut between the two (H. Nagamochi, T. Ono,
/// T. Ibaraki, "Implementing an efficient minimum capacity cut algorithm", 1994). This holds for the sets as they are at the start.
fn scan(
    kernel: &Kernel,
    packing: &Packing,
    sets: &mut UnionFind,
    mut visit: impl FnMut(u32, f64, &mut UnionFind),
) {
    let nodes = kernel.node_count();
    let set: Vec<u32> = (0..nodes as u32).map(|node| sets.find(node)).collect();
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); nodes];
    for (node, &set) in set.iter().enumerate() {
        members[set as usize].push(node as u32);
    }
    let mut received = vec![0.0; nodes];
    let mut visited = vec![false; nodes];
    let mut heap = BinaryHeap::new();
    for start in 0..nodes as u32 {
        if set[start as usize] == start {
            heap.push((0, start));
        }
        while let Some((_, current)) = heap.pop() {
            if std::mem::replace(&mut visited[current as usize], true) {
                continue;
            }
            for &(other, edge) in members[current as usize].iter().flat_map(|&node| kernel.arcs(node)) {
                let (other, capacity) = (set[other as usize], packing.residual[edge as usize]);
                if visited[other as usize] || kernel.costs[edge as usize] <= 0.0 || capacity <= 0.0 {
                    continue;
                }
                let received: &mut f64 = &mut received[other as usize];
                *received += capacity;
                visit(edge, *received, sets);
                // The bits of numbers that are not negative are in their order.
                heap.push((received.to_bits(), other));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::budget::Budget;

    const NODES: usize = 6;

    /// Every multicut of a few nodes, as labels: all vectors in which a label exceeds those before it by at most one.
    fn all_labels() -> Vec<Vec<u32>> {
        let mut all = vec![vec![0]];
        for _ in 1..NODES {
            all = all
                .into_iter()
                .flat_map(|labels| {
                    let next = labels.iter().max().map_or(0, |&label| label + 1);
                    (0..=next).map(move |label| [labels.as_slice(), &[label]].concat())
                })
                .collect();
        }
        all
    }

    #[test]
    fn what_is_left_out_reaches_the_goal() {
        let mut random = ChaCha8Rng::seed_from_u64(1);
        let all = all_labels();
        let (mut joined, mut by_more_than_the_edge) = (0, 0);
        for _ in 0..300 {
            let pairs = (0..NODES as u32).flat_map(|head| (0..head).map(move |tail| (tail, head)));
            let integral = random.random::<bool>();
            let edges: Vec<_> = pairs
                .map(|(tail, head)| {
                    let cost: f64 = random.random_range(-2.0..3.0);
                    (tail, head, if integral { cost.round() } else { cost })
                })
                .filter(|edge| edge.2 != 0.0)
                .collect();
            let graph = SignedGraph::new(NODES, edges.into_iter());
            let kernel = Kernel::new(&graph);
            let mut packing = Packing::new(&kernel);
            packing.extend(&kernel, random.random_range(0..200), &mut Budget::new(None, None));
            let goal = packing.bound + random.random_range(0.5..8.0);
            let fixed = fix(&kernel, &packing, goal);
            assert!(fixed.left_out >= goal);
            for labels in &all {
                let apart = |&(tail, head): &(u32, u32)| labels[tail as usize] != labels[head as usize];
                let excluded = fixed.edges.iter().any(apart);
                assert!(!excluded || graph.objective(labels) >= fixed.left_out - 1e-9, "{labels:?}");
            }
            joined += fixed.edges.len();
            let alone = |&&(tail, head): &&(u32, u32)| {
                let edge = kernel.edge(tail, head).unwrap() as usize;
                kernel.rounded(packing.bound + packing.residual[edge]) < goal
            };
            by_more_than_the_edge += fixed.edges.iter().filter(alone).count();
        }
        assert!(joined > 200 && 3 * by_more_than_the_edge > joined, "{joined} {by_more_than_the_edge}");
    }
}

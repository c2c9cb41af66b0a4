//! Packings of conflicted cycles: lower bounds that carry their own proof.

use std::collections::VecDeque;

use crate::budget::Budget;
use crate::kernel::Kernel;
use crate::landmark_distances::LandmarkDistances;
use crate::signed_graph::SignedGraph;
use crate::union_find::UnionFind;

/// A cycle with exactly one repulsive edge, and the weight it is packed with.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cycle {
    /// Nodes in order; the repulsive edge joins the last to the first.
    pub(crate) nodes: Vec<u32>,
    pub(crate) weight: f64,
}

/// Edge-disjoint up to capacity `|c|`: each multicut pays for every conflicted cycle, by cutting an attractive edge
/// or not cutting the repulsive one, so the sum of negative costs plus all weights is a lower bound.
#[derive(Debug, Clone, Default)]
pub(crate) struct Packing {
    pub(crate) cycles: Vec<Cycle>,
    /// Capacity `|c|` left at each edge.
    pub(crate) residual: Vec<f64>,
    /// Lower bound on the kernel's objective.
    pub(crate) bound: f64,
}

/// Shares of an edge's cost below this count as used up.
const NEGLIGIBLE: f64 = 1e-12;

impl Packing {
    /// The empty packing.
    pub(crate) fn new(kernel: &Kernel) -> Self {
        Self {
            cycles: Vec::new(),
            residual: kernel.costs.iter().map(|cost| cost.abs()).collect(),
            bound: kernel.negative_sum(),
        }
    }

    /// Packs given cycles with given weights, as far as capacities allow: the weights are scaled down where an edge
    /// is overfull.
    pub(crate) fn from_weights(
        kernel: &Kernel,
        cycles: impl Iterator<Item = (Vec<u32>, Vec<u32>, f64)> + Clone,
    ) -> Self {
        let mut packing = Self::new(kernel);
        let mut load = vec![0.0; kernel.edge_count()];
        for (_, edges, weight) in cycles.clone() {
            for edge in edges {
                load[edge as usize] += weight;
            }
        }
        for (nodes, edges, weight) in cycles {
            let share = edges
                .iter()
                .map(|&edge| kernel.costs[edge as usize].abs() / load[edge as usize])
                .fold(1.0, f64::min);
            let weight =
                edges.iter().map(|&edge| packing.residual[edge as usize]).fold(weight * share, f64::min);
            if weight > 0.0 {
                packing.add(nodes, &edges, weight);
            }
        }
        packing
    }

    fn add(&mut self, nodes: Vec<u32>, edges: &[u32], weight: f64) {
        for &edge in edges {
            let residual = &mut self.residual[edge as usize];
            *residual = (*residual - weight).max(0.0);
        }
        self.bound += weight;
        self.cycles.push(Cycle { nodes, weight });
    }

    /// Packs what still fits, shortest cycles first: for growing length and each repulsive edge with capacity left,
    /// a shortest attractive path of edges with capacity left (iterated cycle packing, "ICP": Lange, Karrenbauer,
    /// Andres, ICML 2018, algorithm 1).
    ///
    /// A breadth-first search for each cycle packed, bounded by the length; ends when `effort` is spent.
    pub(crate) fn extend(&mut self, kernel: &Kernel, effort: u64, budget: &mut Budget) {
        let end = budget.spent().saturating_add(effort);
        let mut search = PathSearch::new(kernel.node_count());
        let mut hops = LandmarkDistances::default();
        let mut repulsive: Vec<u32> =
            (0..kernel.edge_count() as u32).filter(|&edge| kernel.costs[edge as usize] < 0.0).collect();
        let mut length = 2;
        while !repulsive.is_empty() {
            let mut components = UnionFind::new(kernel.node_count());
            for (edge, &(tail, head)) in kernel.ends.iter().enumerate() {
                if kernel.costs[edge] > 0.0 && self.open(kernel, edge as u32) {
                    components.union(tail, head);
                }
            }
            repulsive.retain(|&edge| {
                let (tail, head) = kernel.ends[edge as usize];
                self.open(kernel, edge) && components.find(tail) == components.find(head)
            });
            for &repulsive in &repulsive {
                let (tail, head) = kernel.ends[repulsive as usize];
                if hops.at_least(tail, head) > length as f32 {
                    continue;
                }
                while self.open(kernel, repulsive) {
                    let open = |edge| self.open(kernel, edge);
                    let path = search.shortest(kernel, repulsive, length, &hops, open, budget);
                    if budget.is_over() || budget.spent() > end {
                        return;
                    }
                    let Some(nodes) = path else { break };
                    let edges = kernel.cycle_edges(&nodes);
                    let weight =
                        edges.iter().map(|&edge| self.residual[edge as usize]).fold(f64::INFINITY, f64::min);
                    self.add(nodes, &edges, weight);
                }
            }
            if length >= kernel.node_count() {
                break;
            }
            length = if length < 6 { length + 1 } else { length * 2 };
            if length == 6 {
                // Paths only grow longer as capacity goes.
                hops = LandmarkDistances::hops(kernel);
            }
        }
    }

    fn open(&self, kernel: &Kernel, edge: u32) -> bool {
        self.residual[edge as usize] > NEGLIGIBLE * kernel.costs[edge as usize].abs()
    }
}

/// Largest graph, in edges, that [`pack_completely`] looks at.
const SMALL: usize = 20_000;

/// Work that [`pack_completely`] spends on each edge.
const EFFORT: u64 = 60;

/// Cycles that pack every repulsive edge to its cost. No multicut of such a graph costs less than 0: joining everything
/// that attracts is optimal.
///
/// Asks first for what every such packing needs: at each node as much attraction as repulsion.
pub(crate) fn pack_completely(graph: &SignedGraph, budget: &mut Budget) -> Option<Vec<Cycle>> {
    let mut arcs = 0;
    for node in graph.nodes() {
        let row = graph.arcs(node);
        arcs += row.len();
        if row.iter().map(|arc| arc.cost).sum::<f64>() < 0.0 || arcs > 2 * SMALL {
            return None;
        }
    }
    let kernel = Kernel::new(graph);
    let mut packing = Packing::new(&kernel);
    packing.extend(&kernel, EFFORT * kernel.edge_count() as u64, budget);
    let mut edges = 0..kernel.edge_count() as u32;
    let left = edges.any(|edge| kernel.costs[edge as usize] < 0.0 && packing.open(&kernel, edge));
    (!left).then_some(packing.cycles)
}

/// Breadth-first search for attractive paths between the ends of a repulsive edge.
struct PathSearch {
    parent: Vec<u32>,
    queue: VecDeque<(u32, usize)>,
    seen: Vec<u32>,
}

impl PathSearch {
    fn new(node_count: usize) -> Self {
        Self { parent: vec![u32::MAX; node_count], queue: VecDeque::new(), seen: Vec::new() }
    }

    fn shortest(
        &mut self,
        kernel: &Kernel,
        repulsive: u32,
        length: usize,
        hops: &LandmarkDistances,
        open: impl Fn(u32) -> bool,
        budget: &mut Budget,
    ) -> Option<Vec<u32>> {
        let (start, goal) = kernel.ends[repulsive as usize];
        self.queue.clear();
        self.queue.push_back((start, 0));
        self.parent[start as usize] = start;
        self.seen.push(start);
        let mut found = None;
        'search: while let Some((node, depth)) = self.queue.pop_front() {
            budget.spend(if depth + 1 == length { 1 } else { kernel.arcs(node).len() as u64 });
            // One step from the end, only the goal itself is of use.
            if depth + 1 == length {
                if let Some(edge) = kernel.edge(node, goal)
                    && edge != repulsive
                    && kernel.costs[edge as usize] > 0.0
                    && open(edge)
                {
                    self.parent[goal as usize] = node;
                    self.seen.push(goal);
                    found = Some(goal);
                    break 'search;
                }
                continue;
            }
            for &(other, edge) in kernel.arcs(node) {
                if kernel.costs[edge as usize] > 0.0 && self.parent[other as usize] == u32::MAX && open(edge)
                {
                    self.parent[other as usize] = node;
                    self.seen.push(other);
                    if other == goal {
                        found = Some(goal);
                        break 'search;
                    }
                    if (depth + 1) as f32 + hops.at_least(other, goal) <= length as f32 {
                        self.queue.push_back((other, depth + 1));
                    }
                }
            }
        }
        let path = found.map(|goal| {
            let mut path = vec![goal];
            let mut node = goal;
            while node != start {
                node = self.parent[node as usize];
                path.push(node);
            }
            path
        });
        for node in self.seen.drain(..) {
            self.parent[node as usize] = u32::MAX;
        }
        path
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_conflicted_triangle_is_packed_to_its_smallest_cost() {
        let graph = SignedGraph::new(3, [(0, 1, 2.0), (1, 2, 3.0), (0, 2, -4.0)].into_iter());
        let kernel = Kernel::new(&graph);
        let mut packing = Packing::new(&kernel);
        packing.extend(&kernel, u64::MAX, &mut Budget::new(None, None));
        assert_eq!((packing.bound, packing.cycles.len()), (-2.0, 1));
        assert_eq!(packing.residual, [0.0, 2.0, 1.0]);
    }

    #[test]
    fn a_graph_is_packed_completely_only_if_every_repulsion_is() {
        let ring = [(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0), (0, 3, 1.0)];
        let chord = |cost: f64| SignedGraph::new(4, ring.into_iter().chain([(0, 2, cost)]));
        let budget = &mut Budget::new(None, None);
        assert_eq!(pack_completely(&chord(-2.0), budget).map(|cycles| cycles.len()), Some(2));
        assert_eq!(pack_completely(&chord(-2.5), budget), None);
        // Enough attraction at each node, and no path to carry it.
        let apart = [(0, 1, 2.0), (2, 3, 2.0), (0, 2, -1.0), (1, 3, -1.0)];
        assert_eq!(pack_completely(&SignedGraph::new(4, apart.into_iter()), budget), None);
    }

    #[test]
    fn overfull_weights_are_scaled_to_capacity() {
        let graph = SignedGraph::new(3, [(0, 1, 2.0), (1, 2, 3.0), (0, 2, -4.0)].into_iter());
        let kernel = Kernel::new(&graph);
        let cycle = (vec![0, 1, 2], kernel.cycle_edges(&[0, 1, 2]), 50.0);
        assert_eq!(Packing::from_weights(&kernel, std::iter::once(cycle)).bound, -2.0);
    }
}

//! Packings of conflicts: lower bounds with their own proof.

use std::collections::VecDeque;

use super::conflict::Conflict;
use super::landmark_distances::LandmarkDistances;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;

/// A conflict and the weight it is packed with.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Packed {
    pub(crate) conflict: Conflict,
    pub(crate) weight: f64,
}

/// Conflicts packed with weights, such that the weights over each edge add up to at most its capacity `|c|`; an edge that a
/// conflict uses twice counts twice. For every conflict, each multicut pays at least [`Conflict::least`], by cutting
/// attractive edges or by not cutting repulsive ones. So the sum of negative costs, plus the sum of weights times that value,
/// is a lower bound. A multicut that pays for an edge with capacity left pays that much more.
#[derive(Debug, Clone, Default)]
pub(crate) struct Packing {
    pub(crate) conflicts: Vec<Packed>,
    /// Remaining capacity of `|c|` at each edge.
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
            conflicts: Vec::new(),
            residual: kernel.costs.iter().map(|cost| cost.abs()).collect(),
            bound: kernel.negative_sum(),
        }
    }

    /// Packs given conflicts, with their uses and weights, as far as capacities allow: weights are scaled down where an edge
    /// is overfull.
    pub(crate) fn from_weights<'a>(
        kernel: &Kernel,
        conflicts: impl Iterator<Item = (&'a Conflict, &'a [(u32, u32)], f64)> + Clone,
    ) -> Self {
        let mut packing = Self::new(kernel);
        let mut load = vec![0.0; kernel.edge_count()];
        for (_, uses, weight) in conflicts.clone() {
            for &(edge, times) in uses {
                load[edge as usize] += f64::from(times) * weight;
            }
        }
        for (conflict, uses, weight) in conflicts.clone() {
            let share = uses
                .iter()
                .map(|&(edge, _)| kernel.costs[edge as usize].abs() / load[edge as usize])
                .fold(1.0, f64::min);
            let weight = packing.room(uses).min(weight * share);
            if weight > 0.0 {
                packing.add(conflict.clone(), uses, weight);
            }
        }
        // Cycles can be searched for in the remaining capacity, but others not as fast, so they are filled up here.
        for (conflict, uses, _) in conflicts.filter(|entry| !matches!(entry.0, Conflict::Cycle(_))) {
            let room = packing.room(uses);
            if room > 0.0 {
                packing.add(conflict.clone(), uses, room);
            }
        }
        packing
    }

    /// The largest weight that still fits.
    pub(crate) fn room(&self, uses: &[(u32, u32)]) -> f64 {
        let room = |&(edge, times): &(u32, u32)| self.residual[edge as usize] / f64::from(times);
        uses.iter().map(room).fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn add(&mut self, conflict: Conflict, uses: &[(u32, u32)], weight: f64) {
        for &(edge, times) in uses {
            let residual = &mut self.residual[edge as usize];
            *residual = (*residual - f64::from(times) * weight).max(0.0);
        }
        self.bound += conflict.least() * weight;
        self.conflicts.push(Packed { conflict, weight });
    }

    /// Packs the cycles that still fit, shortest first. For increasing length and each repulsive edge with capacity left,
    /// finds a shortest attractive path of edges with capacity left (iterated cycle packing, "ICP": Lange, Karrenbauer,
    /// Andres, ICML 2018, algorithm 1).
    ///
    /// One breadth-first search for each packed cycle, bounded by the length; ends when `effort` is spent.
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
                    let cycle = Conflict::Cycle(nodes);
                    let uses = cycle.uses(kernel);
                    let weight = self.room(&uses);
                    self.add(cycle, &uses, weight);
                }
            }
            if length >= kernel.node_count() {
                break;
            }
            length = if length < 6 { length + 1 } else { length * 2 };
            if length == 6 {
                // Paths only get longer as capacity is used up, so these distances remain lower bounds.
                hops = LandmarkDistances::hops(kernel);
            }
        }
    }

    fn open(&self, kernel: &Kernel, edge: u32) -> bool {
        self.residual[edge as usize] > NEGLIGIBLE * kernel.costs[edge as usize].abs()
    }
}

/// Largest graph, in edges, that [`pack_completely`] tries.
const SMALL: usize = 20_000;

/// Work that [`pack_completely`] spends on each edge.
const EFFORT: u64 = 60;

/// Cycles that pack every repulsive edge up to its cost. If they exist, no multicut of the graph costs less than 0, so
/// joining everything that attracts is optimal.
///
/// First checks a necessary condition: each node has at least as much attraction as repulsion.
pub(crate) fn pack_completely(graph: &SignedGraph, budget: &mut Budget) -> Option<Vec<Packed>> {
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
    (!left).then_some(packing.conflicts)
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
            // One step before the length limit, only the goal itself is useful.
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
        assert_eq!((packing.bound, packing.conflicts.len()), (-2.0, 1));
        assert_eq!(packing.residual, [0.0, 2.0, 1.0]);
    }

    #[test]
    fn a_graph_is_packed_completely_only_if_every_repulsion_is() {
        let ring = [(0, 1, 1.0), (1, 2, 1.0), (2, 3, 1.0), (0, 3, 1.0)];
        let chord = |cost: f64| SignedGraph::new(4, ring.into_iter().chain([(0, 2, cost)]));
        let budget = &mut Budget::new(None, None);
        assert_eq!(pack_completely(&chord(-2.0), budget).map(|cycles| cycles.len()), Some(2));
        assert_eq!(pack_completely(&chord(-2.5), budget), None);
        // Enough attraction at each node, but no path of attractive edges.
        let apart = [(0, 1, 2.0), (2, 3, 2.0), (0, 2, -1.0), (1, 3, -1.0)];
        assert_eq!(pack_completely(&SignedGraph::new(4, apart.into_iter()), budget), None);
    }

    #[test]
    fn overfull_weights_are_scaled_to_capacity() {
        let graph = SignedGraph::new(3, [(0, 1, 2.0), (1, 2, 3.0), (0, 2, -4.0)].into_iter());
        let kernel = Kernel::new(&graph);
        let cycle = Conflict::Cycle(vec![0, 1, 2]);
        let uses = cycle.uses(&kernel);
        assert_eq!(Packing::from_weights(&kernel, std::iter::once((&cycle, &uses[..], 50.0))).bound, -2.0);
    }
}

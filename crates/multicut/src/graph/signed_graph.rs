//! A signed graph that shrinks by contraction: reductions and heuristics work on it.

use super::union_find::UnionFind;

/// One direction of an edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arc {
    pub(crate) node: u32,
    pub(crate) cost: f64,
}

/// A simple graph as sorted adjacency vectors; contraction merges two of them. No arc has cost 0.
#[derive(Debug, Clone, Default)]
pub(crate) struct SignedGraph {
    adjacency: Vec<Vec<Arc>>,
}

impl SignedGraph {
    /// Builds a graph; adds up parallel edges, and drops those that cancel.
    pub(crate) fn new(node_count: usize, edges: impl Iterator<Item = (u32, u32, f64)> + Clone) -> Self {
        let mut degrees = vec![0usize; node_count];
        for (tail, head, _) in edges.clone() {
            degrees[tail as usize] += 1;
            degrees[head as usize] += 1;
        }
        let mut adjacency: Vec<Vec<Arc>> = degrees.into_iter().map(Vec::with_capacity).collect();
        for (tail, head, cost) in edges {
            adjacency[tail as usize].push(Arc { node: head, cost });
            adjacency[head as usize].push(Arc { node: tail, cost });
        }
        for arcs in &mut adjacency {
            // Sort by cost, too, so that the order in which parallel costs add up does not depend on the input.
            arcs.sort_unstable_by(|a, b| a.node.cmp(&b.node).then(a.cost.total_cmp(&b.cost)));
            arcs.dedup_by(|next, kept| {
                let parallel = next.node == kept.node;
                if parallel {
                    kept.cost += next.cost;
                }
                parallel
            });
            arcs.retain(|arc| arc.cost != 0.0);
        }
        Self { adjacency }
    }

    pub(crate) fn node_count(&self) -> usize {
        self.adjacency.len()
    }

    pub(crate) fn arcs(&self, node: u32) -> &[Arc] {
        &self.adjacency[node as usize]
    }

    pub(crate) fn nodes(&self) -> std::ops::Range<u32> {
        0..self.adjacency.len() as u32
    }

    /// Every edge once, with `tail < head`, in sorted order.
    pub(crate) fn edges(&self) -> impl Iterator<Item = (u32, u32, f64)> + Clone + '_ {
        self.nodes().flat_map(|tail| {
            let arcs = self.arcs(tail);
            let above = arcs.partition_point(|arc| arc.node < tail);
            arcs[above..].iter().map(move |arc| (tail, arc.node, arc.cost))
        })
    }

    /// Cost of an edge, 0 if there is none.
    pub(crate) fn cost(&self, tail: u32, head: u32) -> f64 {
        let arcs = self.arcs(tail);
        arcs.binary_search_by_key(&head, |arc| arc.node).map_or(0.0, |place| arcs[place].cost)
    }

    fn add_arc(&mut self, tail: u32, head: u32, cost: f64) {
        let arcs = &mut self.adjacency[tail as usize];
        match arcs.binary_search_by_key(&head, |arc| arc.node) {
            Ok(place) => {
                arcs[place].cost += cost;
                if arcs[place].cost == 0.0 {
                    arcs.remove(place);
                }
            }
            Err(place) if cost != 0.0 => arcs.insert(place, Arc { node: head, cost }),
            Err(_) => {}
        }
    }

    fn remove_arc(&mut self, tail: u32, head: u32) {
        let arcs = &mut self.adjacency[tail as usize];
        if let Ok(place) = arcs.binary_search_by_key(&head, |arc| arc.node) {
            arcs.remove(place);
        }
    }

    /// Adds to the cost of an edge; creates the edge, or removes it at cost 0, if necessary.
    pub(crate) fn add_cost(&mut self, tail: u32, head: u32, cost: f64) {
        self.add_arc(tail, head, cost);
        self.add_arc(head, tail, cost);
    }

    /// Removes a node's edges and returns them.
    pub(crate) fn detach(&mut self, node: u32) -> Vec<Arc> {
        let arcs = std::mem::take(&mut self.adjacency[node as usize]);
        for arc in &arcs {
            self.remove_arc(arc.node, node);
        }
        arcs
    }

    /// Joins two nodes: the one with more edges (then the one with the smaller number) remains, and parallel costs add up.
    /// Returns the remaining node, the removed one, and the arcs that the latter had.
    ///
    /// Linear in the smaller degree, apart from moving memory.
    pub(crate) fn contract(&mut self, first: u32, second: u32) -> (u32, u32, Vec<Arc>) {
        let weight = |node: u32| (std::cmp::Reverse(self.arcs(node).len()), node);
        let (kept, gone) = if weight(first) <= weight(second) { (first, second) } else { (second, first) };
        let mut arcs = std::mem::take(&mut self.adjacency[gone as usize]);
        self.remove_arc(kept, gone);
        arcs.retain(|arc| arc.node != kept);
        for arc in &arcs {
            self.remove_arc(arc.node, gone);
            self.add_arc(arc.node, kept, arc.cost);
        }
        self.merge_into(kept, &arcs);
        (kept, gone, arcs)
    }

    fn merge_into(&mut self, kept: u32, arcs: &[Arc]) {
        if arcs.len() * 8 < self.arcs(kept).len() {
            for arc in arcs {
                self.add_arc(kept, arc.node, arc.cost);
            }
            return;
        }
        let old = std::mem::take(&mut self.adjacency[kept as usize]);
        let mut merged = Vec::with_capacity(old.len() + arcs.len());
        let (mut left, mut right) = (old.iter().peekable(), arcs.iter().peekable());
        loop {
            let next = match (left.peek(), right.peek()) {
                (None, None) => break,
                (Some(_), None) => left.next(),
                (None, Some(_)) => right.next(),
                (Some(a), Some(b)) if a.node < b.node => left.next(),
                (Some(a), Some(b)) if b.node < a.node => right.next(),
                (Some(a), Some(b)) => {
                    let sum = Arc { node: a.node, cost: a.cost + b.cost };
                    left.next();
                    right.next();
                    if sum.cost != 0.0 {
                        merged.push(sum);
                    }
                    continue;
                }
            };
            merged.extend(next);
        }
        self.adjacency[kept as usize] = merged;
    }

    /// Sum of the negative costs: no multicut costs less.
    pub(crate) fn negative_sum(&self) -> f64 {
        self.edges().map(|(_, _, cost)| cost.min(0.0)).sum()
    }

    /// Objective of a labelling.
    pub(crate) fn objective(&self, labels: &[u32]) -> f64 {
        let mut sum = crate::graph::sum::Sum::default();
        for (tail, head, cost) in self.edges() {
            if labels[tail as usize] != labels[head as usize] {
                sum.add(cost);
            }
        }
        sum.value()
    }

    /// Splits label classes into connected components. The multicut remains the same, and uncut edges connect every class.
    pub(crate) fn connected_labels(&self, labels: &[u32]) -> Vec<u32> {
        let mut sets = UnionFind::new(self.node_count());
        for (tail, head, _) in self.edges() {
            if labels[tail as usize] == labels[head as usize] {
                sets.union(tail, head);
            }
        }
        sets.labels()
    }

    /// The same graph with node `order[i]` as node `i`; moves rows instead of copying them.
    pub(crate) fn permuted(mut self, order: &[u32]) -> Self {
        let mut place = vec![0; order.len()];
        for (index, &node) in order.iter().enumerate() {
            place[node as usize] = index as u32;
        }
        let adjacency = order.iter().map(|&node| {
            let mut arcs = std::mem::take(&mut self.adjacency[node as usize]);
            for arc in &mut arcs {
                arc.node = place[arc.node as usize];
            }
            arcs.sort_unstable_by_key(|arc| arc.node);
            arcs
        });
        Self { adjacency: adjacency.collect() }
    }

    /// Moves the edges among `nodes` to a separate graph, with nodes numbered in the order of `nodes`. Moves rows, and copies
    /// only those of nodes with other edges. `place` is scratch with one entry for each node, and is left unchanged.
    pub(crate) fn take(&mut self, nodes: &[u32], place: &mut [u32]) -> Self {
        for (index, &node) in nodes.iter().enumerate() {
            place[node as usize] = index as u32;
        }
        let adjacency = nodes.iter().map(|&node| {
            let row = &mut self.adjacency[node as usize];
            let inside = |arc: &Arc| place[arc.node as usize] != u32::MAX;
            let mut arcs = if row.iter().all(inside) {
                std::mem::take(row)
            } else {
                let arcs = row.iter().copied().filter(inside).collect();
                row.retain(|arc| !inside(arc));
                arcs
            };
            for arc in &mut arcs {
                arc.node = place[arc.node as usize];
            }
            arcs.sort_unstable_by_key(|arc| arc.node);
            arcs
        });
        let adjacency = adjacency.collect();
        for &node in nodes {
            place[node as usize] = u32::MAX;
        }
        Self { adjacency }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(graph: &SignedGraph) -> Vec<(u32, u32, f64)> {
        graph.edges().collect()
    }

    #[test]
    fn parallel_edges_add_and_cancel() {
        let list = [(0, 1, 1.0), (1, 0, 2.0), (1, 2, 1.0), (2, 1, -1.0)];
        assert_eq!(edges(&SignedGraph::new(3, list.into_iter())), [(0, 1, 3.0)]);
    }

    #[test]
    fn contraction_adds_the_costs_to_common_neighbours() {
        let list = [(0, 1, 1.0), (0, 2, 2.0), (1, 2, -5.0), (1, 3, 4.0)];
        let mut graph = SignedGraph::new(4, list.into_iter());
        let (kept, gone, _) = graph.contract(0, 1);
        assert_eq!((kept, gone), (1, 0));
        assert_eq!(edges(&graph), [(1, 2, -3.0), (1, 3, 4.0)]);
    }

    #[test]
    fn contraction_drops_edges_that_cancel() {
        let list = [(0, 1, 1.0), (0, 2, 2.0), (1, 2, -2.0)];
        let mut graph = SignedGraph::new(3, list.into_iter());
        graph.contract(0, 1);
        assert_eq!(edges(&graph), []);
    }
}

//! The graph that reductions leave, with numbered edges.

use super::signed_graph::SignedGraph;

/// A signed graph in compressed rows with numbered edges: the fixed form for bounds and linear programs.
#[derive(Debug, Clone)]
pub(crate) struct Kernel {
    /// The ends of each edge, smaller first; edges are sorted.
    pub(crate) ends: Vec<(u32, u32)>,
    pub(crate) costs: Vec<f64>,
    starts: Vec<u32>,
    /// Pairs (neighbour, edge), sorted within a row.
    arcs: Vec<(u32, u32)>,
    /// Whether all costs are integers, so that bounds round up.
    pub(crate) integral: bool,
}

impl Kernel {
    pub(crate) fn new(graph: &SignedGraph) -> Self {
        let (mut ends, mut costs) = (Vec::new(), Vec::new());
        for (tail, head, cost) in graph.edges() {
            ends.push((tail, head));
            costs.push(cost);
        }
        let mut starts = vec![0u32; graph.node_count() + 1];
        for &(tail, head) in &ends {
            starts[tail as usize + 1] += 1;
            starts[head as usize + 1] += 1;
        }
        for node in 0..graph.node_count() {
            starts[node + 1] += starts[node];
        }
        let mut next = starts.clone();
        let mut arcs = vec![(0, 0); ends.len() * 2];
        // Sorted edges fill rows in order: first the arcs to smaller nodes, then those to larger ones.
        for (edge, &(tail, head)) in ends.iter().enumerate() {
            for (node, other) in [(head, tail), (tail, head)] {
                arcs[next[node as usize] as usize] = (other, edge as u32);
                next[node as usize] += 1;
            }
        }
        let integral = costs.iter().all(|cost| cost.fract() == 0.0);
        Self { ends, costs, starts, arcs, integral }
    }

    pub(crate) fn node_count(&self) -> usize {
        self.starts.len() - 1
    }

    pub(crate) fn edge_count(&self) -> usize {
        self.ends.len()
    }

    /// Neighbours and edges at a node, sorted by neighbour.
    pub(crate) fn arcs(&self, node: u32) -> &[(u32, u32)] {
        &self.arcs[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }

    /// Number of the edge between two nodes.
    pub(crate) fn edge(&self, tail: u32, head: u32) -> Option<u32> {
        let arcs = self.arcs(tail);
        arcs.binary_search_by_key(&head, |arc| arc.0).ok().map(|place| arcs[place].1)
    }

    /// The cost of cutting every repulsive edge and no attractive one: the bound without any conflict.
    pub(crate) fn negative_sum(&self) -> f64 {
        self.costs.iter().filter(|cost| **cost < 0.0).sum()
    }

    /// A bound, rounded up where costs are integers.
    pub(crate) fn rounded(&self, bound: f64) -> f64 {
        if self.integral { (bound - 1e-6 * (1.0 + bound.abs() * 1e-6)).ceil() } else { bound }
    }

    /// The edges of the cycle through these nodes, including the edge from the last node back to the first.
    pub(crate) fn cycle_edges(&self, cycle: &[u32]) -> Vec<u32> {
        let next = cycle.iter().skip(1).chain(cycle.first());
        cycle.iter().zip(next).filter_map(|(&tail, &head)| self.edge(tail, head)).collect()
    }
}

//! How well the capacity that a packing leaves connects two nodes.

use std::collections::{BTreeMap, VecDeque};

use super::part::Part;

/// The capacities of attractive edges, without limit between nodes that are known to be joined.
pub(super) struct Connections {
    capacity: Vec<BTreeMap<u32, f64>>,
    /// From which node a search reached each node, and in which search.
    reached: Vec<(u32, u32)>,
    search: u32,
}

impl Connections {
    /// Those of a graph with these residual capacities, which are stored at the smaller end of an edge.
    pub(super) fn new(kernel: &Part, residual: &Part) -> Self {
        let mut capacity = vec![BTreeMap::new(); kernel.arcs.len()];
        for (tail, arcs) in (0u32..).zip(&kernel.arcs) {
            for (&head, _) in arcs.range(tail + 1..).filter(|arc| *arc.1 > 0.0) {
                let left = residual.cost(tail, head);
                capacity[tail as usize].insert(head, left);
                capacity[head as usize].insert(tail, left);
            }
        }
        Self { reached: vec![(0, 0); capacity.len()], capacity, search: 0 }
    }

    /// A flow between two nodes that cannot be increased or reaches `enough`: each cut between them has at least as much capacity. Along
    /// shortest paths (J. Edmonds, R. M. Karp, "Theoretical improvements in algorithmic efficiency for network flow problems", 1972).
    pub(super) fn flow(&mut self, tail: u32, head: u32, enough: f64) -> f64 {
        let mut flow: BTreeMap<(u32, u32), f64> = BTreeMap::new();
        let mut total = 0.0;
        while total < enough && self.search(tail, head, &flow) {
            let mut path = vec![head];
            while let Some(&last) = path.last().filter(|&&last| last != tail) {
                path.push(self.reached[last as usize].0);
            }
            let steps = || path.windows(2).map(|pair| (pair[1], pair[0]));
            let most = steps().map(|step| self.left(step, &flow)).fold(f64::INFINITY, f64::min);
            if most.is_infinite() {
                return most;
            }
            for (from, to) in steps() {
                *flow.entry((from, to)).or_insert(0.0) += most;
                *flow.entry((to, from)).or_insert(0.0) -= most;
            }
            total += most;
        }
        total
    }

    /// Joins two nodes.
    pub(super) fn join(&mut self, tail: u32, head: u32) {
        for (a, b) in [(tail, head), (head, tail)] {
            self.capacity[a as usize].insert(b, f64::INFINITY);
        }
    }

    fn left(&self, (from, to): (u32, u32), flow: &BTreeMap<(u32, u32), f64>) -> f64 {
        self.capacity[from as usize].get(&to).copied().unwrap_or(0.0) - flow.get(&(from, to)).unwrap_or(&0.0)
    }

    /// Breadth-first search over edges with capacity left.
    fn search(&mut self, tail: u32, head: u32, flow: &BTreeMap<(u32, u32), f64>) -> bool {
        self.search += 1;
        let mut queue = VecDeque::from([tail]);
        self.reached[tail as usize] = (tail, self.search);
        while let Some(node) = queue.pop_front() {
            if node == head {
                return true;
            }
            for &other in self.capacity[node as usize].keys() {
                let place = other as usize;
                if self.reached[place].1 != self.search && self.left((node, other), flow) > 0.0 {
                    self.reached[place] = (node, self.search);
                    queue.push_back(other);
                }
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flow_is_a_least_cut_and_joined_nodes_carry_any() {
        let mut kernel = Part::new(5);
        for (tail, head, cost) in
            [(0, 1, 3.0), (0, 2, 2.0), (1, 2, 1.0), (1, 3, 1.0), (2, 3, 4.0), (0, 4, -9.0), (3, 4, -9.0)]
        {
            kernel.add(tail, head, cost);
        }
        let mut connections = Connections::new(&kernel, &kernel);
        // The cut around 0 and 1 has 2 + 1 + 1, that around 3 has 5; no path leads over repulsive edges.
        assert_eq!(connections.flow(0, 3, f64::INFINITY), 4.0);
        assert_eq!(connections.flow(3, 0, f64::INFINITY), 4.0);
        assert!(connections.flow(0, 3, 2.5) >= 2.5);
        assert_eq!(connections.flow(0, 4, f64::INFINITY), 0.0);
        connections.join(1, 2);
        assert_eq!(connections.flow(0, 3, f64::INFINITY), 5.0);
        connections.join(0, 3);
        assert_eq!(connections.flow(0, 3, f64::INFINITY), f64::INFINITY);
    }
}

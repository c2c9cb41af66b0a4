//! Clusters and the costs between them during contraction.

use std::collections::BTreeMap;

use super::signed_graph::{Arc, SignedGraph};

/// Rows with more arcs than this are trees, because one insertion into a long list would move half of it.
const LONG: usize = 256;

/// A simple signed graph for contraction. Unlike [`SignedGraph`], which uses only vectors, it uses trees for nodes with many
/// neighbours. The clusters of a band along whole sessions soon have many.
#[derive(Debug)]
pub(crate) struct ClusterGraph {
    rows: Vec<Row>,
}

#[derive(Debug)]
enum Row {
    /// Sorted by node.
    List(Vec<Arc>),
    Tree(BTreeMap<u32, f64>),
}

impl Row {
    fn new(arcs: Vec<Arc>) -> Self {
        if arcs.len() <= LONG {
            Self::List(arcs)
        } else {
            Self::Tree(arcs.into_iter().map(|arc| (arc.node, arc.cost)).collect())
        }
    }

    fn len(&self) -> usize {
        match self {
            Self::List(arcs) => arcs.len(),
            Self::Tree(arcs) => arcs.len(),
        }
    }

    fn into_arcs(self) -> Vec<Arc> {
        match self {
            Self::List(arcs) => arcs,
            Self::Tree(arcs) => arcs.into_iter().map(|(node, cost)| Arc { node, cost }).collect(),
        }
    }

    fn cost(&self, node: u32) -> f64 {
        match self {
            Self::List(arcs) => {
                arcs.binary_search_by_key(&node, |arc| arc.node).map_or(0.0, |place| arcs[place].cost)
            }
            Self::Tree(arcs) => arcs.get(&node).copied().unwrap_or(0.0),
        }
    }

    /// Sets the cost of an arc; 0 removes the arc.
    fn set(&mut self, node: u32, cost: f64) {
        match self {
            Self::List(arcs) => match arcs.binary_search_by_key(&node, |arc| arc.node) {
                Ok(place) if cost == 0.0 => {
                    arcs.remove(place);
                }
                Ok(place) => arcs[place].cost = cost,
                Err(_) if cost == 0.0 => {}
                Err(place) => arcs.insert(place, Arc { node, cost }),
            },
            Self::Tree(arcs) if cost == 0.0 => {
                arcs.remove(&node);
            }
            Self::Tree(arcs) => {
                arcs.insert(node, cost);
            }
        }
    }

    /// Adds arcs to the row, and writes the sum to each of them.
    fn merge(&mut self, added: &mut [Arc]) {
        match self {
            Self::List(arcs) if added.len() * 8 >= arcs.len() => {
                let mut merged = Vec::with_capacity(arcs.len() + added.len());
                let mut old = arcs.iter().copied().peekable();
                for arc in added {
                    while let Some(before) = old.next_if(|old| old.node < arc.node) {
                        merged.push(before);
                    }
                    if let Some(same) = old.next_if(|old| old.node == arc.node) {
                        arc.cost += same.cost;
                    }
                    if arc.cost != 0.0 {
                        merged.push(*arc);
                    }
                }
                merged.extend(old);
                *self = Self::new(merged);
            }
            _ => {
                for arc in added {
                    arc.cost += self.cost(arc.node);
                    self.set(arc.node, arc.cost);
                }
            }
        }
    }
}

impl ClusterGraph {
    /// A graph in which every node is its own cluster.
    pub(crate) fn new(graph: &SignedGraph) -> Self {
        Self { rows: graph.nodes().map(|node| Row::new(graph.arcs(node).to_vec())).collect() }
    }

    /// Number of neighbours.
    pub(crate) fn degree(&self, node: u32) -> usize {
        self.rows[node as usize].len()
    }

    /// Cost between two clusters, 0 if there is none.
    pub(crate) fn cost(&self, tail: u32, head: u32) -> f64 {
        if self.degree(tail) <= self.degree(head) {
            self.rows[tail as usize].cost(head)
        } else {
            self.rows[head as usize].cost(tail)
        }
    }

    /// Adds to the cost between two clusters.
    pub(crate) fn add_cost(&mut self, tail: u32, head: u32, cost: f64) {
        let sum = self.cost(tail, head) + cost;
        self.rows[tail as usize].set(head, sum);
        self.rows[head as usize].set(tail, sum);
    }

    /// Joins two clusters: the one with more neighbours (then the one with the smaller number) remains, and parallel costs
    /// add up. Returns the remaining cluster, the removed one, and the arcs that the latter had, with their new costs (0
    /// where they cancelled).
    ///
    /// `O(d log n)`, where `d` is the smaller number of neighbours.
    pub(crate) fn contract(&mut self, first: u32, second: u32) -> (u32, u32, Vec<Arc>) {
        let weight = |node: u32| (std::cmp::Reverse(self.degree(node)), node);
        let (kept, gone) = if weight(first) <= weight(second) { (first, second) } else { (second, first) };
        let row = std::mem::replace(&mut self.rows[gone as usize], Row::List(Vec::new()));
        let mut arcs = row.into_arcs();
        arcs.retain(|arc| arc.node != kept);
        self.rows[kept as usize].set(gone, 0.0);
        self.rows[kept as usize].merge(&mut arcs);
        for arc in &arcs {
            let row = &mut self.rows[arc.node as usize];
            row.set(gone, 0.0);
            row.set(kept, arc.cost);
        }
        (kept, gone, arcs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_rows_and_short_ones_contract_alike() {
        // Two hubs with common neighbours, whose costs cancel in part; compared with the same graph in vectors.
        for leaves in [10, 2 * LONG as u32] {
            let cost = |leaf: u32, hub: u32| f64::from((leaf * 7 + hub) % 5) - 2.0;
            let edges = (2..2 + leaves)
                .flat_map(|leaf| [(0, leaf, cost(leaf, 0)), (1, leaf, cost(leaf, 1))])
                .chain([(0, 1, 1.0), (2, 3, -1.0)]);
            let mut plain = SignedGraph::new(2 + leaves as usize, edges);
            let mut clusters = ClusterGraph::new(&plain);
            for (tail, head) in [(2, 3), (0, 1)] {
                let (kept, gone, arcs) = clusters.contract(tail, head);
                assert_eq!(
                    (kept, gone),
                    (plain.contract(tail, head).0, if kept == tail { head } else { tail })
                );
                assert!(arcs.iter().all(|arc| arc.cost == plain.cost(kept, arc.node)));
            }
            for node in plain.nodes() {
                assert_eq!(clusters.degree(node), plain.arcs(node).len());
                assert!(plain.arcs(node).iter().all(|arc| clusters.cost(node, arc.node) == arc.cost));
            }
        }
    }
}

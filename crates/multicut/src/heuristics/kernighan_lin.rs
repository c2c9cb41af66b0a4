//! Kernighan-Lin with joins.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;

/// Number of moves after the best one before a sequence is given up: minimum, per node of the smaller cluster, and maximum.
const PATIENCE: (usize, usize, usize) = (20, 2, 200);

/// The same for splitting a cluster, which needs more moves before it gains: half of a band has to leave.
const PATIENCE_OF_SPLITS: usize = 10_000;

/// Gains below this share of the absolute costs are rounding errors. If they counted, sequences would never end.
const TOLERANCE: f64 = 1e-12;

/// Improves `labels` by Kernighan-Lin with joins (Keuper et al., ICCV 2015, algorithm 1, "KLj"). For each pair of
/// neighbouring clusters, it takes the best prefix of a sequence of moves across their border, or joins both. For each
/// cluster, it splits off a part. It repeats while something improves, and never worsens.
///
/// Two clusters are neighbours if some edge between them attracts. If all edges between them repel, nodes that gain by moving
/// across gain as much by leaving, and splitting finds that. Most pairs of clusters are of that kind.
///
/// Each sequence takes its moves from a heap: `O(b log b)` for `b` arcs at the nodes that come near the border.
pub(crate) fn kernighan_lin_with_joins(graph: &SignedGraph, labels: &mut Vec<u32>, budget: &mut Budget) {
    if budget.is_over() {
        return;
    }
    Search::new(graph, labels).run(budget);
    *labels = graph.connected_labels(labels);
}

/// Nodes by the gain of moving them, with ties to the smaller number. Outdated entries stay until they are popped.
type Heap = BinaryHeap<(Key, Reverse<u32>)>;

/// A sequence of moves, the gain of its best prefix, and the length of that prefix.
struct Moves {
    nodes: Vec<u32>,
    gain: f64,
    length: usize,
}

struct Search<'a> {
    graph: &'a SignedGraph,
    labels: &'a mut Vec<u32>,
    members: Vec<Vec<u32>>,
    /// Whether each cluster changed in this round (`changed`) and in the last round (`recent`).
    changed: Vec<bool>,
    recent: Vec<bool>,
    /// Gain of moving a node to the other cluster, valid if `stamp` is the current sequence.
    gain: Vec<f64>,
    stamp: Vec<u32>,
    moved: Vec<bool>,
    sequence: u32,
    tolerance: f64,
}

impl<'a> Search<'a> {
    fn new(graph: &'a SignedGraph, labels: &'a mut Vec<u32>) -> Self {
        let clusters = labels.iter().max().map_or(0, |&label| label as usize + 1);
        let mut members = vec![Vec::new(); clusters];
        for (node, &label) in labels.iter().enumerate() {
            members[label as usize].push(node as u32);
        }
        let magnitude: f64 = graph.edges().map(|(_, _, cost)| cost.abs()).sum();
        let nodes = graph.node_count();
        Self {
            graph,
            labels,
            members,
            changed: vec![true; clusters],
            recent: Vec::new(),
            gain: vec![0.0; nodes],
            stamp: vec![0; nodes],
            moved: vec![false; nodes],
            sequence: 0,
            tolerance: magnitude * TOLERANCE,
        }
    }

    fn run(&mut self, budget: &mut Budget) {
        loop {
            self.recent = std::mem::replace(&mut self.changed, vec![false; self.members.len()]);
            // Only clusters that changed in the last round can improve in this one.
            let mut pairs: Vec<(u32, u32)> = self
                .graph
                .edges()
                .filter(|edge| edge.2 > 0.0)
                .map(|(tail, head, _)| {
                    let (a, b) = (self.labels[tail as usize], self.labels[head as usize]);
                    (a.min(b), a.max(b))
                })
                .filter(|&(a, b)| a != b && (self.recent[a as usize] || self.recent[b as usize]))
                .collect();
            pairs.sort_unstable();
            pairs.dedup();
            let mut gained = false;
            for (a, b) in pairs {
                if !self.members[a as usize].is_empty() && !self.members[b as usize].is_empty() {
                    gained |= self.improve(a, b, budget);
                }
                if budget.is_over() {
                    return;
                }
            }
            for cluster in 0..self.members.len() as u32 {
                let touched = self.recent.get(cluster as usize).copied().unwrap_or(true)
                    || self.changed[cluster as usize];
                while touched && self.members[cluster as usize].len() > 1 {
                    let fresh = self.members.len() as u32;
                    self.members.push(Vec::new());
                    self.changed.push(false);
                    if !self.improve(cluster, fresh, budget) || budget.is_over() {
                        break;
                    }
                    gained = true;
                }
            }
            if !gained || budget.is_over() {
                return;
            }
        }
    }

    /// Gain of moving `node` from cluster `from` to cluster `to`.
    fn gain_of(&self, node: u32, from: u32, to: u32) -> f64 {
        let mut gain = 0.0;
        for arc in self.graph.arcs(node) {
            let label = self.labels[arc.node as usize];
            if label == to {
                gain += arc.cost;
            } else if label == from {
                gain -= arc.cost;
            }
        }
        gain
    }

    /// Takes the best prefix of moves between clusters `a` and `b`, or joins them; true if the objective fell.
    fn improve(&mut self, a: u32, b: u32, budget: &mut Budget) -> bool {
        self.sequence += 1;
        let splitting = self.members[b as usize].is_empty();
        // Search the border from the smaller cluster. An empty one borders everywhere.
        let (near, far) = if splitting || self.members[a as usize].len() <= self.members[b as usize].len() {
            (a, b)
        } else {
            (b, a)
        };
        let mut heap = BinaryHeap::new();
        let between = self.find_border(near, far, &mut heap, budget);
        let Moves { nodes, gain, length } =
            self.move_across((a, b), self.patience(near, splitting), heap, budget);
        for &node in &nodes {
            self.moved[node as usize] = false;
        }
        // Joining gains the cost of all edges between the two. At equal gain moves win, because they keep both clusters for
        // later sequences.
        let join = between > gain + self.tolerance && !splitting;
        for &node in &nodes[if join { 0 } else { length }..] {
            let label = &mut self.labels[node as usize];
            *label = if *label == a { b } else { a };
        }
        if join {
            self.join(near, far);
        } else if length > 0 {
            self.regroup(a, b);
        } else {
            return false;
        }
        self.changed[a as usize] = true;
        self.changed[b as usize] = true;
        true
    }

    /// Moves tried after the best one: more for larger clusters, which may need more moves before they gain.
    fn patience(&self, near: u32, splitting: bool) -> usize {
        if splitting {
            return PATIENCE_OF_SPLITS;
        }
        let (least, each, most) = PATIENCE;
        (least + each * self.members[near as usize].len()).min(most)
    }

    /// Adds all nodes with an edge to the other cluster to the heap; of a cluster to be split, all nodes. Returns the cost of
    /// the edges between the clusters.
    fn find_border(&mut self, near: u32, far: u32, heap: &mut Heap, budget: &mut Budget) -> f64 {
        let splitting = self.members[far as usize].is_empty();
        let mut between = 0.0;
        let mut work = 1;
        for index in 0..self.members[near as usize].len() {
            let node = self.members[near as usize][index];
            let graph = self.graph;
            work += graph.arcs(node).len();
            let mut border = splitting;
            for arc in graph.arcs(node) {
                if self.labels[arc.node as usize] == far {
                    between += arc.cost;
                    border = true;
                    work += self.touch(arc.node, far, near, heap);
                }
            }
            if border {
                work += self.touch(node, near, far, heap);
            }
        }
        budget.spend(work as u64);
        between
    }

    /// Repeatedly moves the node that gains most, each node once, until `patience` moves bring nothing better. Losing moves
    /// count, too, because the way out of a local minimum leads through them (Kernighan, Lin, Bell System Technical Journal
    /// 49(2), 1970).
    fn move_across(
        &mut self,
        (a, b): (u32, u32),
        patience: usize,
        mut heap: Heap,
        budget: &mut Budget,
    ) -> Moves {
        let mut best = Moves { nodes: Vec::new(), gain: 0.0, length: 0 };
        let mut total = 0.0;
        while let Some((Key(gain), Reverse(node))) = heap.pop() {
            // An entry is outdated if its node has moved or its gain has changed since; then the heap has a newer one.
            if self.moved[node as usize] || self.gain[node as usize] != gain {
                continue;
            }
            let (from, to) = if self.labels[node as usize] == a { (a, b) } else { (b, a) };
            self.moved[node as usize] = true;
            self.labels[node as usize] = to;
            best.nodes.push(node);
            total += gain;
            if total > best.gain + self.tolerance {
                best.gain = total;
                best.length = best.nodes.len();
            } else if best.nodes.len() >= best.length + patience {
                break;
            }
            let work = self.update_neighbours(node, from, (a, b), &mut heap);
            if !budget.spend(1 + work as u64) {
                break;
            }
        }
        best
    }

    /// Updates the gains of a node's neighbours after the node has left `from`; returns the number of arcs visited.
    fn update_neighbours(&mut self, node: u32, from: u32, (a, b): (u32, u32), heap: &mut Heap) -> usize {
        let graph = self.graph;
        let mut work = graph.arcs(node).len();
        for arc in graph.arcs(node) {
            let label = self.labels[arc.node as usize];
            if self.moved[arc.node as usize] || (label != a && label != b) {
                continue;
            }
            if self.stamp[arc.node as usize] == self.sequence {
                // Moving towards `node` now gains the cost that moving away from it lost before, and vice versa.
                self.gain[arc.node as usize] += if label == from { 2.0 * arc.cost } else { -2.0 * arc.cost };
                heap.push((Key(self.gain[arc.node as usize]), Reverse(arc.node)));
            } else {
                let other = if label == a { b } else { a };
                work += self.touch(arc.node, label, other, heap);
            }
        }
        work
    }

    /// Adds a node to the candidates of this sequence; returns the number of arcs visited.
    fn touch(&mut self, node: u32, from: u32, to: u32, heap: &mut Heap) -> usize {
        if self.stamp[node as usize] == self.sequence {
            return 0;
        }
        self.stamp[node as usize] = self.sequence;
        self.gain[node as usize] = self.gain_of(node, from, to);
        heap.push((Key(self.gain[node as usize]), Reverse(node)));
        self.graph.arcs(node).len()
    }

    fn join(&mut self, gone: u32, kept: u32) {
        let nodes = std::mem::take(&mut self.members[gone as usize]);
        for &node in &nodes {
            self.labels[node as usize] = kept;
        }
        self.members[kept as usize].extend(nodes);
    }

    fn regroup(&mut self, a: u32, b: u32) {
        let mut all = std::mem::take(&mut self.members[a as usize]);
        all.append(&mut self.members[b as usize]);
        // Sort the members, so that later sequences depend on earlier ones only through the partition.
        all.sort_unstable();
        for node in all {
            let label = self.labels[node as usize];
            self.members[label as usize].push(node);
        }
    }
}

/// A gain as a heap key.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Key(f64);

impl Eq for Key {}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn improved(edges: &[(u32, u32, f64)], labels: &[u32]) -> (f64, Vec<u32>) {
        let graph = SignedGraph::new(labels.len(), edges.iter().copied());
        let mut labels = labels.to_vec();
        kernighan_lin_with_joins(&graph, &mut labels, &mut Budget::new(None, None));
        (graph.objective(&labels), labels)
    }

    #[test]
    fn joins_clusters_that_attract() {
        assert_eq!(improved(&[(0, 1, 1.0), (1, 2, 1.0), (0, 2, -1.5)], &[0, 1, 2]).0, -0.5);
    }

    #[test]
    fn splits_a_cluster() {
        assert_eq!(
            improved(&[(0, 1, 3.0), (2, 3, 3.0), (0, 2, -1.0), (1, 3, -1.0), (1, 2, 1.0)], &[0; 4]).0,
            -1.0
        );
    }

    #[test]
    fn moves_two_nodes_where_no_single_move_gains() {
        // Nodes 2 and 3 attract each other by 5, and are attracted less by their wrong cluster than by the right one.
        let edges = [(0, 2, 1.0), (0, 3, 1.0), (1, 2, 2.0), (1, 3, 2.0), (2, 3, 5.0), (0, 1, -9.0)];
        assert_eq!(improved(&edges, &[0, 1, 0, 0]), (-7.0, vec![0, 1, 1, 1]));
    }
}

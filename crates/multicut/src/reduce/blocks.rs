//! Parts of a graph that can be cut independently.

use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;

/// Independent parts of a graph.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// The cost of repulsive edges outside all parts, which can be cut without conflict.
    pub(crate) constant: f64,
    /// Node sets of the blocks with edges of both signs, each sorted.
    pub(crate) conflicted: Vec<Vec<u32>>,
    /// Pairs of nodes to join: the edges of blocks without repulsion.
    pub(crate) joined: Vec<(u32, u32)>,
}

/// Splits a graph into its conflicted blocks.
///
/// A repulsive edge between different components of the attractive edges is on no cycle with exactly one repulsive edge, so
/// it is cut without conflict. The cycles of the rest stay within biconnected blocks, and the inequalities of the multicut
/// polytope come from cycles, so blocks are independent. A block without repulsive edges (for example an attractive bridge)
/// is joined. Linear time: Hopcroft and Tarjan (CACM 1973), without recursion.
pub(crate) fn split(graph: &SignedGraph) -> Parts {
    let mut parts = Parts::default();
    let mut components = UnionFind::new(graph.node_count());
    for (tail, head, cost) in graph.edges() {
        if cost > 0.0 {
            components.union(tail, head);
        }
    }
    let component: Vec<u32> = graph.nodes().map(|node| components.find(node)).collect();
    for (tail, head, cost) in graph.edges() {
        if component[tail as usize] != component[head as usize] {
            parts.constant += cost;
        }
    }
    Search::new(graph, &component).run(&mut parts);
    parts
}

struct Search<'a> {
    graph: &'a SignedGraph,
    component: &'a [u32],
    /// Order of discovery, from 1; 0 is undiscovered.
    depth: Vec<u32>,
    low: Vec<u32>,
    next_arc: Vec<u32>,
    time: u32,
    edges: Vec<(u32, u32, f64)>,
}

impl<'a> Search<'a> {
    fn new(graph: &'a SignedGraph, component: &'a [u32]) -> Self {
        let nodes = graph.node_count();
        let (depth, low, next_arc) = (vec![0; nodes], vec![0; nodes], vec![0; nodes]);
        Self { graph, component, depth, low, next_arc, time: 0, edges: Vec::new() }
    }

    fn run(mut self, parts: &mut Parts) {
        let mut path: Vec<(u32, u32)> = Vec::new();
        for root in self.graph.nodes() {
            if self.depth[root as usize] != 0 {
                continue;
            }
            self.discover(root);
            path.push((root, root));
            while let Some(&(node, parent)) = path.last() {
                let Some(&arc) = self.graph.arcs(node).get(self.next_arc[node as usize] as usize) else {
                    path.pop();
                    if let Some(&(above, _)) = path.last() {
                        self.low[above as usize] = self.low[above as usize].min(self.low[node as usize]);
                        if self.low[node as usize] >= self.depth[above as usize] {
                            self.close(above, node, parts);
                        }
                    }
                    continue;
                };
                self.next_arc[node as usize] += 1;
                let other = arc.node;
                if other == parent || self.component[other as usize] != self.component[node as usize] {
                    continue;
                }
                if self.depth[other as usize] == 0 {
                    self.edges.push((node, other, arc.cost));
                    self.discover(other);
                    path.push((other, node));
                } else if self.depth[other as usize] < self.depth[node as usize] {
                    self.edges.push((node, other, arc.cost));
                    self.low[node as usize] = self.low[node as usize].min(self.depth[other as usize]);
                }
            }
        }
    }

    fn discover(&mut self, node: u32) {
        self.time += 1;
        self.depth[node as usize] = self.time;
        self.low[node as usize] = self.time;
    }

    /// Pops the block whose first edge is `(above, node)` from the stack of edges.
    fn close(&mut self, above: u32, node: u32, parts: &mut Parts) {
        let start = self.edges.iter().rposition(|&(tail, head, _)| (tail, head) == (above, node));
        let block = self.edges.split_off(start.unwrap_or(0));
        if block.iter().all(|&(_, _, cost)| cost > 0.0) {
            parts.joined.extend(block.iter().map(|&(tail, head, _)| (tail, head)));
        } else {
            let mut nodes: Vec<u32> = block.iter().flat_map(|&(tail, head, _)| [tail, head]).collect();
            nodes.sort_unstable();
            nodes.dedup();
            parts.conflicted.push(nodes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_triangles_at_a_node_are_two_blocks() {
        let list = [
            (0, 1, 1.0),
            (1, 2, 1.0),
            (2, 0, -1.0), // conflicted
            (2, 3, 1.0),
            (3, 4, 1.0),
            (4, 2, 1.0), // attractive only
            (4, 5, 1.0), // bridge
            (5, 6, -2.0),
            (7, 1, -3.0), // towards other components
        ];
        let parts = split(&SignedGraph::new(8, list.into_iter()));
        assert_eq!(parts.conflicted, [vec![0, 1, 2]]);
        assert_eq!(parts.constant, -5.0);
        let mut joined = UnionFind::new(8);
        for (tail, head) in parts.joined {
            joined.union(tail, head);
        }
        assert_eq!(joined.labels(), [0, 1, 2, 2, 2, 2, 3, 4]);
    }

    #[test]
    fn a_repulsive_bridge_between_attractive_parts_is_cut() {
        let parts = split(&SignedGraph::new(4, [(0, 1, 1.0), (1, 2, -1.0), (2, 3, 1.0)].into_iter()));
        assert!(parts.conflicted.is_empty());
        assert_eq!(parts.constant, -1.0);
    }

    #[test]
    fn a_long_path_does_not_exhaust_the_stack() {
        let n = 200_000;
        let cycle = (0..n).map(|i| (i, (i + 1) % n, if i == 0 { -1.0 } else { 1.0 }));
        assert_eq!(split(&SignedGraph::new(n as usize, cycle)).conflicted[0].len(), n as usize);
    }
}

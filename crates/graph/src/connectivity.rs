//! Connected components of a graph. All stages share this definition of "connected" and differ only in the edges that count.

use crate::{Edge, PoseGraph};

/// The nodes and edges of one connected component.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    /// Nodes, ascending.
    pub nodes: Vec<usize>,
    /// Edges, ascending.
    pub edges: Vec<usize>,
}

/// Splits a graph into its connected components, in the order of their first nodes.
///
/// `edges` gives the two ends of each edge, which must be below `nodes`. A node without edges is a component of its own.
/// Takes almost linear time.
pub fn connected_components(
    nodes: usize,
    edges: impl Iterator<Item = (usize, usize)> + Clone,
) -> Vec<Component> {
    let mut forest = Forest::new(nodes);
    for (a, b) in edges.clone() {
        forest.join(a, b);
    }
    let mut index = vec![usize::MAX; nodes];
    let mut components: Vec<Component> = Vec::new();
    for node in 0..nodes {
        let root = forest.root(node);
        if index[root] == usize::MAX {
            index[root] = components.len();
            components.push(Component { nodes: Vec::new(), edges: Vec::new() });
        }
        components[index[root]].nodes.push(node);
    }
    for (edge, (a, _)) in edges.enumerate() {
        components[index[forest.root(a)]].edges.push(edge);
    }
    components
}

/// Disjoint sets with path halving. The smaller root becomes the root of a union, so the roots do not depend on set sizes.
#[derive(Clone, Debug)]
pub struct Forest {
    parent: Vec<usize>,
}

impl Forest {
    /// Every node in a set of its own.
    pub fn new(nodes: usize) -> Self {
        Self { parent: (0..nodes).collect() }
    }

    /// The representative of the set that contains this node: the lowest node of the set.
    pub fn root(&mut self, mut node: usize) -> usize {
        while self.parent[node] != node {
            self.parent[node] = self.parent[self.parent[node]];
            node = self.parent[node];
        }
        node
    }

    /// Joins the sets of two nodes; returns whether they were separate before.
    pub fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
        a != b
    }
}

impl PoseGraph {
    /// The indices of an edge's nodes, `from` and `to`. O(1) if ids count from 0, else O(log n).
    pub fn ends(&self, edge: &Edge) -> Option<(usize, usize)> {
        Some((self.node_index(edge.from)?, self.node_index(edge.to)?))
    }

    /// For each node the first node of its component. Only edges in use for which `counts` is true join nodes. Almost linear.
    pub fn first_of_part(&self, counts: impl Fn(&Edge) -> bool) -> Vec<usize> {
        let mut forest = Forest::new(self.nodes.len());
        let joining = self.edges.iter().filter(|edge| edge.in_use() && counts(edge));
        for (from, to) in joining.filter_map(|edge| self.ends(edge)) {
            forest.join(from, to);
        }
        (0..self.nodes.len()).map(|node| forest.root(node)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_come_in_the_order_of_their_first_nodes() {
        let parts = connected_components(5, [(4, 1), (3, 0)].into_iter());
        let nodes: Vec<Vec<usize>> = parts.iter().map(|part| part.nodes.clone()).collect();
        assert_eq!(nodes, [vec![0, 3], vec![1, 4], vec![2]]);
        assert_eq!(parts[1].edges, [0]);
    }

    #[test]
    fn only_edges_in_use_that_count_hold_parts_together() {
        let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":7}
{"kind":"node","id":8}
{"kind":"node","id":9}
{"kind":"landmark","id":0,"from":9,"to":8}
{"kind":"landmark","id":1,"from":7,"to":8,"rejected_by":"pcm"}
"#;
        let graph = PoseGraph::read("test", text.as_bytes()).unwrap();
        assert_eq!(graph.first_of_part(|_| true), [0, 1, 1]);
        assert_eq!(graph.first_of_part(|edge| edge.measurement.is_some()), [0, 1, 2]);
    }
}

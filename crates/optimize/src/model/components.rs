//! Connected parts of a graph.

/// Nodes and edges of one connected part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Component {
    /// Nodes, ascending.
    pub nodes: Vec<usize>,
    /// Edges, ascending.
    pub edges: Vec<usize>,
}

impl Component {
    /// Puts the nodes that are held first and returns how many there are. Where none is, the first node alone is held: it
    /// only fixes the gauge.
    pub(crate) fn put_held_first(&mut self, held: &[bool]) -> usize {
        self.nodes.sort_by_key(|&node| !held[node]);
        self.held(held).max(1)
    }

    /// How many of its nodes are held.
    pub(crate) fn held(&self, held: &[bool]) -> usize {
        self.nodes.iter().filter(|&&node| held[node]).count()
    }
}

/// Splits a graph into its connected parts, in the order of their first nodes.
///
/// `edges` gives the two ends of each edge, which must be below `nodes`. A node without edges is a part of its own.
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

/// Disjoint sets with path halving; the smaller root wins, so that the result does not depend on sizes.
pub(crate) struct Forest {
    parent: Vec<usize>,
}

impl Forest {
    pub(crate) fn new(nodes: usize) -> Self {
        Self { parent: (0..nodes).collect() }
    }

    pub(crate) fn root(&mut self, mut node: usize) -> usize {
        while self.parent[node] != node {
            self.parent[node] = self.parent[self.parent[node]];
            node = self.parent[node];
        }
        node
    }

    /// Whether the two were apart before.
    pub(crate) fn join(&mut self, a: usize, b: usize) -> bool {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
        a != b
    }
}

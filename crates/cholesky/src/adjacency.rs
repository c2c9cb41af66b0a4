//! Neighbours of vertices, as lists one after the other.

/// For every vertex a list of other ends: of its edges, of its children, or of whatever arcs it was made from.
pub struct Adjacency {
    starts: Vec<usize>,
    neighbours: Vec<usize>,
}

impl Adjacency {
    /// Lists, for each vertex, the other ends of the arcs `(vertex, other)` in their order. Goes through the arcs twice. O(vertices + arcs).
    pub fn new(vertices: usize, arcs: impl Iterator<Item = (usize, usize)> + Clone) -> Self {
        let mut starts = vec![0; vertices + 1];
        for (vertex, _) in arcs.clone() {
            starts[vertex + 1] += 1;
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; starts[vertices]];
        for (vertex, other) in arcs {
            neighbours[next[vertex]] = other;
            next[vertex] += 1;
        }
        Self { starts, neighbours }
    }

    /// The other ends at a vertex.
    pub fn of(&self, vertex: usize) -> &[usize] {
        &self.neighbours[self.starts[vertex]..self.starts[vertex + 1]]
    }
}

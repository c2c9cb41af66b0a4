//! Neighbours of vertices, as lists stored one after the other.

/// For every vertex the list of the other ends of its arcs: neighbours, children, or others.
pub struct Adjacency {
    starts: Vec<usize>,
    neighbours: Vec<usize>,
}

impl Adjacency {
    /// Lists, for each vertex, the other ends of the arcs `(vertex, other)` in their order. Iterates twice over the arcs.
    /// O(vertices + arcs).
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

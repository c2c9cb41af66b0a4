//! Graphs with weights, which nested dissection takes apart and makes coarser.

use std::cmp::Reverse;

/// A vertex that is not there.
const NONE: u32 = u32::MAX;

/// An undirected graph: the neighbours of the vertices, one list after the other.
#[derive(Clone, Default)]
pub(super) struct Graph {
    /// Where the lists begin, and where the last one ends.
    starts: Vec<usize>,
    neighbours: Vec<u32>,
    /// For each neighbour, how many edges the one to it stands for.
    strengths: Vec<u32>,
    /// For each vertex, how many variables it stands for.
    weights: Vec<u32>,
}

impl Graph {
    /// The graph of single variables with these edges, each given once. There are fewer than 2^32 variables.
    pub(super) fn new(vertices: usize, pairs: &[(usize, usize)]) -> Self {
        let mut starts = vec![0; vertices + 1];
        for &(a, b) in pairs {
            starts[a + 1] += 1;
            starts[b + 1] += 1;
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; 2 * pairs.len()];
        for &(a, b) in pairs {
            for (from, to) in [(a, b), (b, a)] {
                neighbours[next[from]] = to as u32;
                next[from] += 1;
            }
        }
        let strengths = vec![1; neighbours.len()];
        Self { starts, neighbours, strengths, weights: vec![1; vertices] }
    }

    fn empty() -> Self {
        Self { starts: vec![0], ..Self::default() }
    }

    /// Ends the list of a vertex with this weight.
    fn end_vertex(&mut self, weight: u32) {
        self.starts.push(self.neighbours.len());
        self.weights.push(weight);
    }

    pub(super) fn vertices(&self) -> usize {
        self.weights.len()
    }

    pub(super) fn weight(&self, vertex: usize) -> u32 {
        self.weights[vertex]
    }

    /// The weight of all vertices.
    pub(super) fn total(&self) -> u64 {
        self.weights.iter().map(|&weight| u64::from(weight)).sum()
    }

    /// The neighbours of a vertex.
    pub(super) fn of(&self, vertex: usize) -> &[u32] {
        &self.neighbours[self.starts[vertex]..self.starts[vertex + 1]]
    }

    /// The neighbours of a vertex, and the strengths of the edges to them.
    fn edges(&self, vertex: usize) -> impl Iterator<Item = (u32, u32)> {
        let list = self.starts[vertex]..self.starts[vertex + 1];
        self.neighbours[list.clone()].iter().copied().zip(self.strengths[list].iter().copied())
    }

    /// For each label below `count`, its vertices in ascending order, and the subgraph of them.
    pub(super) fn split(&self, labels: &[usize], count: usize) -> Vec<(Vec<u32>, Self)> {
        let mut parts = vec![Vec::new(); count];
        let mut place = vec![NONE; self.vertices()];
        for (vertex, &label) in labels.iter().enumerate() {
            if let Some(part) = parts.get_mut(label) {
                place[vertex] = part.len() as u32;
                part.push(vertex as u32);
            }
        }
        let subgraph = |vertices: Vec<u32>| {
            let mut graph = Self::empty();
            for vertex in vertices.iter().map(|&vertex| vertex as usize) {
                for (neighbour, strength) in self.edges(vertex) {
                    if labels[neighbour as usize] == labels[vertex] {
                        graph.neighbours.push(place[neighbour as usize]);
                        graph.strengths.push(strength);
                    }
                }
                graph.end_vertex(self.weights[vertex]);
            }
            (vertices, graph)
        };
        parts.into_iter().map(subgraph).collect()
    }

    /// A graph in which each vertex stands for one or two neighbours of this graph, no heavier than this, and the name in it of each
    /// vertex. The strongest edges contract (G. Karypis and V. Kumar, "A fast and high quality multilevel scheme for partitioning irregular
    /// graphs", 1998).
    pub(super) fn coarser(&self, heaviest: u64) -> (Self, Vec<u32>) {
        let (members, names) = self.matching(heaviest);
        let mut graph = Self::empty();
        // Where the list that is being made has the edge to a vertex.
        let mut place = vec![usize::MAX; members.len()];
        for (name, pair) in members.iter().enumerate() {
            let start = graph.neighbours.len();
            let mut weight = 0;
            for member in pair.iter().filter(|&&member| member != NONE).map(|&member| member as usize) {
                weight += self.weights[member];
                for (neighbour, strength) in self.edges(member) {
                    let other = names[neighbour as usize] as usize;
                    if other == name {
                        continue;
                    }
                    // An older entry is that of another list.
                    let at = place[other];
                    if at < start || at == usize::MAX {
                        place[other] = graph.neighbours.len();
                        graph.neighbours.push(other as u32);
                        graph.strengths.push(strength);
                    } else {
                        graph.strengths[at] += strength;
                    }
                }
            }
            graph.end_vertex(weight);
        }
        (graph, names)
    }

    /// Pairs of neighbours, and single vertices, no heavier than this, and the pair of each vertex.
    fn matching(&self, heaviest: u64) -> (Vec<[u32; 2]>, Vec<u32>) {
        let mut names = vec![NONE; self.vertices()];
        let mut pairs = Vec::new();
        for vertex in 0..self.vertices() {
            if names[vertex] != NONE {
                continue;
            }
            let weight = |vertex: u32| u64::from(self.weights[vertex as usize]);
            let room = heaviest.saturating_sub(weight(vertex as u32));
            let partner = self
                .edges(vertex)
                .filter(|&(other, _)| names[other as usize] == NONE && weight(other) <= room)
                .max_by_key(|&(other, strength)| (strength, Reverse(weight(other)), Reverse(other)))
                .map_or(NONE, |(other, _)| other);
            names[vertex] = pairs.len() as u32;
            if partner != NONE {
                names[partner as usize] = pairs.len() as u32;
            }
            pairs.push([vertex as u32, partner]);
        }
        (pairs, names)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three pairs, of which the first is joined to the second by one edge and to the third by two.
    fn example() -> Graph {
        Graph::new(6, &[(0, 1), (0, 2), (2, 3), (0, 4), (1, 5), (4, 5)])
    }

    #[test]
    fn a_coarser_graph_keeps_weights_and_the_edges_between_pairs() {
        let fine = example();
        let (coarse, names) = fine.coarser(2);
        assert_eq!(names, [0, 0, 1, 1, 2, 2]);
        assert_eq!(coarse.total(), fine.total());
        let edges: Vec<Vec<(u32, u32)>> = (0..3).map(|vertex| coarse.edges(vertex).collect()).collect();
        assert_eq!(edges, [vec![(1, 1), (2, 2)], vec![(0, 1)], vec![(0, 2)]]);
        // Pairs of this weight have no room for another one; then the stronger edge contracts.
        assert_eq!(coarse.coarser(3).0.vertices(), 3);
        assert_eq!(coarse.coarser(4).1, [0, 1, 0]);
    }

    #[test]
    fn a_subgraph_has_the_edges_between_its_vertices() {
        let parts = example().split(&[0, 1, 1, 0, 0, 7], 2);
        let neighbours = |graph: &Graph| -> Vec<Vec<u32>> {
            (0..graph.vertices()).map(|vertex| graph.of(vertex).to_vec()).collect()
        };
        assert_eq!((&parts[0].0, neighbours(&parts[0].1)), (&vec![0, 3, 4], vec![vec![2], vec![], vec![0]]));
        assert_eq!((&parts[1].0, neighbours(&parts[1].1)), (&vec![1, 2], vec![vec![], vec![]]));
    }
}

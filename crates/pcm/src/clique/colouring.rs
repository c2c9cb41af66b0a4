//! Colourings by the conflicts between vertices.
//!
//! All vertices of a class conflict with each other, so a clique has at most one vertex of each class, and no more vertices
//! than there are classes.

use super::{BitGraph, BitSet};

/// The conflicts of each vertex. A vertex may be among its own conflicts.
pub(super) trait Conflicts {
    fn of(&self, vertex: usize) -> impl Iterator<Item = usize>;
}

/// Conflicts among the vertices `alive`, from the rows of the bit matrix.
pub(super) struct Rows<'a> {
    pub(super) graph: &'a BitGraph,
    pub(super) alive: &'a BitSet,
}

impl Conflicts for Rows<'_> {
    fn of(&self, vertex: usize) -> impl Iterator<Item = usize> {
        self.alive.members_outside(self.graph.neighbours(vertex))
    }
}

/// Conflicts as lists: faster than rows of bits if vertices have few conflicts.
pub(super) struct Lists(Vec<Vec<u32>>);

impl Lists {
    /// The conflicts of a whole graph.
    pub(super) fn of_graph(graph: &BitGraph) -> Self {
        let all = BitSet::full(graph.len());
        let list = |vertex: usize| {
            let outside = all.members_outside(graph.neighbours(vertex));
            outside.filter(|&other| other != vertex).map(|other| other as u32).collect()
        };
        Self((0..graph.len()).map(list).collect())
    }

    /// The cost of a pass over all of them: vertices, and conflicts from both ends.
    pub(super) fn cost(&self) -> usize {
        1 + self.0.len() + self.0.iter().map(Vec::len).sum::<usize>()
    }
}

impl Conflicts for Lists {
    fn of(&self, vertex: usize) -> impl Iterator<Item = usize> {
        self.0[vertex].iter().map(|&other| other as usize)
    }
}

const UNCOLOURED: u32 = u32::MAX;

/// Classes of vertices that all conflict with each other.
pub(super) struct Colouring {
    pub(super) classes: Vec<Vec<u32>>,
    pub(super) class_of: Vec<u32>,
    /// For each class: how many of its members conflict with the current vertex.
    met: Vec<u32>,
    /// Classes with at least one such member.
    touched: Vec<u32>,
}

impl Colouring {
    pub(super) fn new(vertices: usize) -> Self {
        Self {
            classes: Vec::new(),
            class_of: vec![UNCOLOURED; vertices],
            met: vec![0; vertices],
            touched: Vec::new(),
        }
    }

    /// First fit, in the given order. A vertex fits into a class if it conflicts with all of it, so only conflicts are
    /// visited: O(edges of the complement).
    pub(super) fn colour(&mut self, order: impl IntoIterator<Item = usize>, conflicts: &impl Conflicts) {
        self.classes.clear();
        self.class_of.fill(UNCOLOURED);
        for vertex in order {
            let fitting = self.classes_in_conflict(vertex, conflicts).min();
            let fitting = fitting.unwrap_or_else(|| {
                self.classes.push(Vec::new());
                self.classes.len() as u32 - 1
            });
            self.classes[fitting as usize].push(vertex as u32);
            self.class_of[vertex] = fitting;
        }
    }

    /// Removes a vertex from its class, and returns whether the class is now empty.
    pub(super) fn forget(&mut self, vertex: usize) -> bool {
        let class = &mut self.classes[self.class_of[vertex] as usize];
        class.retain(|&member| member as usize != vertex);
        self.class_of[vertex] = UNCOLOURED;
        class.is_empty()
    }

    /// The classes that conflict as a whole with a vertex. Its own class counts if the vertex is among its own conflicts.
    pub(super) fn classes_in_conflict(
        &mut self,
        vertex: usize,
        conflicts: &impl Conflicts,
    ) -> impl Iterator<Item = u32> {
        for &class in &self.touched {
            self.met[class as usize] = 0;
        }
        self.touched.clear();
        for other in conflicts.of(vertex) {
            let class = self.class_of[other];
            if class != UNCOLOURED {
                let met = &mut self.met[class as usize];
                if *met == 0 {
                    self.touched.push(class);
                }
                *met += 1;
            }
        }
        let Self { classes, met, touched, .. } = self;
        touched.iter().copied().filter(|&class| met[class as usize] as usize == classes[class as usize].len())
    }
}

//! Local search for larger cliques.

use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{BitGraph, BitSet};

/// The number of random vertices from which the one to force in is chosen.
const DRAWS: usize = 8;
/// With more free vertices than this, the first of them joins.
const MANY: usize = 32;

/// Iterated local search with (1,2)-swaps (Andrade, Resende, Werneck 2012, for independent sets of the complement).
///
/// For every vertex the search counts its conflicts: the members of the clique that are not its neighbours. A vertex
/// without conflicts joins. A member gives way to two vertices that conflict with it alone and agree with each other. If no
/// such swap remains, a vertex is forced in and the search continues.
pub(super) struct LocalSearch<'a> {
    graph: &'a BitGraph,
    alive: BitSet,
    inside: BitSet,
    size: usize,
    conflicts: Vec<u32>,
    /// Vertices outside the clique without conflicts.
    free: BitSet,
    /// Vertices outside the clique in conflict with one member.
    single: BitSet,
    /// Members whose swaps have not been tried yet.
    pending: BitSet,
    random: ChaCha8Rng,
}

impl<'a> LocalSearch<'a> {
    /// Starts from a clique within `alive`.
    pub(super) fn new(graph: &'a BitGraph, alive: &BitSet, clique: &[usize]) -> Self {
        let mut search = Self {
            graph,
            alive: alive.clone(),
            inside: BitSet::new(graph.len()),
            size: 0,
            conflicts: vec![0; graph.len()],
            free: alive.clone(),
            single: BitSet::new(graph.len()),
            pending: BitSet::new(graph.len()),
            // A fixed seed: the same graph gives the same clique.
            random: ChaCha8Rng::seed_from_u64(0),
        };
        for &vertex in clique {
            search.insert(vertex);
        }
        search
    }

    /// Runs until the clique has `goal` members, or until `rounds` rounds found nothing larger. Returns the largest clique
    /// found.
    pub(super) fn run(mut self, goal: usize, rounds: usize) -> Vec<usize> {
        self.improve();
        let mut best: Vec<usize> = self.inside.members().collect();
        let vertices: Vec<usize> = self.alive.members().collect();
        let mut since = 0;
        while best.len() < goal && since < rounds && best.len() < vertices.len() {
            since += 1;
            let before = (self.inside.clone(), self.size);
            let Some(vertex) = self.draw_outside(&vertices) else { continue };
            self.force(vertex);
            self.improve();
            if self.size > best.len() {
                best = self.inside.members().collect();
                since = 0;
            } else if self.size < before.1 {
                let loss = (before.1 - self.size) * (best.len() - self.size);
                if self.random.random_range(0..=loss) != 0 {
                    self.restore(&before.0);
                }
            }
        }
        best
    }

    /// Of several random vertices, the one outside the clique that conflicts with fewest members.
    fn draw_outside(&mut self, vertices: &[usize]) -> Option<usize> {
        (0..DRAWS)
            .map(|_| vertices[self.random.random_range(0..vertices.len())])
            .filter(|&vertex| !self.inside.contains(vertex))
            .min_by_key(|&vertex| self.conflicts[vertex])
    }

    fn insert(&mut self, vertex: usize) {
        self.inside.insert(vertex);
        self.size += 1;
        self.free.remove(vertex);
        self.single.remove(vertex);
        self.pending.insert(vertex);
        for other in self.alive.members_outside(self.graph.neighbours(vertex)) {
            if other == vertex {
                continue;
            }
            self.conflicts[other] += 1;
            match self.conflicts[other] {
                1 => {
                    self.free.remove(other);
                    self.single.insert(other);
                }
                2 => self.single.remove(other),
                _ => {}
            }
        }
    }

    fn remove(&mut self, vertex: usize) {
        self.inside.remove(vertex);
        self.size -= 1;
        self.pending.remove(vertex);
        match self.conflicts[vertex] {
            0 => self.free.insert(vertex),
            1 => self.single.insert(vertex),
            _ => {}
        }
        let mut freed = Vec::new();
        for other in self.alive.members_outside(self.graph.neighbours(vertex)) {
            if other == vertex {
                continue;
            }
            self.conflicts[other] -= 1;
            if self.inside.contains(other) {
                continue;
            }
            match self.conflicts[other] {
                0 => {
                    self.single.remove(other);
                    self.free.insert(other);
                }
                1 => {
                    self.single.insert(other);
                    freed.push(other);
                }
                _ => {}
            }
        }
        for other in freed {
            let blocker = self.inside.members_outside(self.graph.neighbours(other)).next();
            if let Some(member) = blocker {
                self.pending.insert(member);
            }
        }
    }

    /// Adds a vertex and removes the members that conflict with it.
    fn force(&mut self, vertex: usize) {
        let rivals: Vec<usize> = self
            .inside
            .members_outside(self.graph.neighbours(vertex))
            .filter(|&rival| rival != vertex)
            .collect();
        for rival in rivals {
            self.remove(rival);
        }
        self.insert(vertex);
    }

    fn restore(&mut self, clique: &BitSet) {
        let gone: Vec<usize> = self.inside.members_outside(clique.words()).collect();
        for vertex in gone {
            self.remove(vertex);
        }
        let back: Vec<usize> = clique.members_outside(self.inside.words()).collect();
        for vertex in back {
            self.insert(vertex);
        }
        self.pending.clear();
    }

    fn improve(&mut self) {
        loop {
            let joining = self.least_in_conflict();
            if let Some(vertex) = joining {
                self.insert(vertex);
                continue;
            }
            let waiting = self.pending.members().next();
            let Some(member) = waiting else { return };
            self.pending.remove(member);
            if let Some((one, other)) = self.pair_for(member) {
                self.remove(member);
                self.insert(one);
                self.insert(other);
            }
        }
    }

    /// The free vertex that conflicts with fewest other free vertices.
    fn least_in_conflict(&self) -> Option<usize> {
        if self.free.count() > MANY {
            return self.free.members().next();
        }
        self.free.members().max_by_key(|&vertex| {
            (self.free.count_within(self.graph.neighbours(vertex)), std::cmp::Reverse(vertex))
        })
    }

    /// Two vertices that are neighbours and conflict with this member alone.
    fn pair_for(&self, member: usize) -> Option<(usize, usize)> {
        let row = self.graph.neighbours(member);
        let rivals: Vec<usize> = self.single.members_outside(row).collect();
        rivals.iter().enumerate().find_map(|(place, &one)| {
            let other =
                rivals[place + 1..].iter().copied().find(|&other| self.graph.connected(one, other))?;
            Some((one, other))
        })
    }
}

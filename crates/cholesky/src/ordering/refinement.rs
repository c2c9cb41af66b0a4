//! Moves of single vertices that improve a cut.
//!
//! In the manner of C. M. Fiduccia and R. M. Mattheyses, "A linear-time heuristic for improving network partitions", 1982, but on vertices
//! instead of edges: a vertex of the separator goes to a side, and its neighbours on the other side come into the separator.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::cut::{Cut, LARGEST, SEPARATOR};
use super::graph::Graph;

/// Number of passes, and number of moves without gain after which a pass ends.
const PASSES: u8 = 6;
const PATIENCE: usize = 60;

/// How much a move to a side lightens the separator, and the vertex that moves; of equal gains, the lowest vertex counts.
type Move = (i64, Reverse<u32>);

impl Cut {
    /// The cut after passes of moves, as long as a pass makes it cheaper. In a pass, every vertex leaves the separator once at most, moves
    /// that gain least of all included, and the cheapest cut on the way is kept. O(edges at moved vertices * log vertices) a pass.
    pub(super) fn improved(self, graph: &Graph) -> Self {
        let vertices = graph.vertices();
        let mut refinement = Refinement {
            graph,
            limit: (LARGEST * graph.total() as f64) as u64,
            members: (0..vertices as u32).filter(|&vertex| self.side[vertex as usize] == SEPARATOR).collect(),
            beside: vec![[0; 2]; vertices],
            left_in: vec![0; vertices],
            moves: Default::default(),
            changes: Vec::new(),
            cut: self,
        };
        for pass in 1..=PASSES {
            if !refinement.pass(pass) {
                break;
            }
        }
        refinement.cut
    }
}

struct Refinement<'a> {
    graph: &'a Graph,
    cut: Cut,
    /// The largest weight of a side.
    limit: u64,
    /// The vertices of the separator, and others.
    members: Vec<u32>,
    /// For each vertex of the separator, the weights of its neighbours on both sides.
    beside: Vec<[u32; 2]>,
    /// For each vertex, the pass in which it last left the separator.
    left_in: Vec<u8>,
    /// The moves to each side. Those with another gain than the present one are void.
    moves: [BinaryHeap<Move>; 2],
    /// Vertices that moved, and where they were before.
    changes: Vec<(u32, u8)>,
}

impl Refinement<'_> {
    /// Returns whether the cut became cheaper.
    fn pass(&mut self, pass: u8) -> bool {
        self.moves.iter_mut().for_each(BinaryHeap::clear);
        self.members.sort_unstable();
        self.members.dedup();
        self.members.retain(|&vertex| self.cut.side[vertex as usize] == SEPARATOR);
        for place in 0..self.members.len() {
            self.enter(self.members[place]);
        }
        let start = self.cut.cost();
        let (mut least, mut kept, mut idle) = (start, 0, 0);
        while idle < PATIENCE
            && let Some((vertex, side)) = self.best_move(pass)
        {
            self.left_in[vertex as usize] = pass;
            self.make(vertex, side);
            let cost = self.cut.cost();
            idle += 1;
            if cost < least {
                (least, kept, idle) = (cost, self.changes.len(), 0);
            }
        }
        for (vertex, side) in self.changes.drain(kept..).rev() {
            self.cut.set(self.graph, vertex as usize, side);
            if side == SEPARATOR {
                self.members.push(vertex);
            }
        }
        self.changes.clear();
        least < start
    }

    /// Takes the vertex whose move lightens the separator most, with its side; of two sides, the one that is lighter now.
    fn best_move(&mut self, pass: u8) -> Option<(u32, u8)> {
        let [first, second] = [0, 1].map(|side| self.best_to(side, pass));
        let side = match (first, second) {
            (None, None) => return None,
            (Some(_), None) => 0,
            (None, Some(_)) => 1,
            (Some((one, _)), Some((other, _))) if one == other => {
                u8::from(self.cut.sizes[1] < self.cut.sizes[0])
            }
            (Some((one, _)), Some((other, _))) => u8::from(other > one),
        };
        let (_, Reverse(vertex)) = self.moves[usize::from(side)].pop()?;
        Some((vertex, side))
    }

    /// The best move to a side, after those that are void or make the side too heavy are gone.
    fn best_to(&mut self, side: usize, pass: u8) -> Option<Move> {
        while let Some(&best) = self.moves[side].peek() {
            let (gain, Reverse(vertex)) = best;
            let index = vertex as usize;
            let is_free = self.cut.side[index] == SEPARATOR && self.left_in[index] != pass;
            let fits = self.cut.sizes[side] + u64::from(self.graph.weight(index)) <= self.limit;
            if is_free && fits && gain == self.gain(vertex, side) {
                return Some(best);
            }
            self.moves[side].pop();
        }
        None
    }

    fn gain(&self, vertex: u32, side: usize) -> i64 {
        i64::from(self.graph.weight(vertex as usize)) - i64::from(self.beside[vertex as usize][1 - side])
    }

    fn offer(&mut self, vertex: u32, side: usize) {
        self.moves[side].push((self.gain(vertex, side), Reverse(vertex)));
    }

    /// Notes the neighbours of a vertex that is in the separator now.
    fn enter(&mut self, vertex: u32) {
        let mut beside = [0; 2];
        for &neighbour in self.graph.of(vertex as usize) {
            if let Some(weight) = beside.get_mut(usize::from(self.cut.side[neighbour as usize])) {
                *weight += self.graph.weight(neighbour as usize);
            }
        }
        self.beside[vertex as usize] = beside;
        self.offer(vertex, 0);
        self.offer(vertex, 1);
    }

    /// Moves a vertex from the separator to a side.
    fn make(&mut self, vertex: u32, side: u8) {
        let (graph, here) = (self.graph, usize::from(side));
        self.changes.push((vertex, SEPARATOR));
        self.cut.set(graph, vertex as usize, side);
        for &neighbour in graph.of(vertex as usize) {
            if self.cut.side[neighbour as usize] == SEPARATOR {
                self.beside[neighbour as usize][here] += graph.weight(vertex as usize);
                self.offer(neighbour, 1 - here);
            }
        }
        for &neighbour in graph.of(vertex as usize) {
            if usize::from(self.cut.side[neighbour as usize]) == 1 - here {
                self.pull(neighbour, 1 - here);
            }
        }
    }

    /// Moves a vertex from a side into the separator.
    fn pull(&mut self, vertex: u32, side: usize) {
        let graph = self.graph;
        self.changes.push((vertex, side as u8));
        self.cut.set(graph, vertex as usize, SEPARATOR);
        self.members.push(vertex);
        self.enter(vertex);
        for &neighbour in graph.of(vertex as usize) {
            if self.cut.side[neighbour as usize] == SEPARATOR {
                self.beside[neighbour as usize][side] -= graph.weight(vertex as usize);
                self.offer(neighbour, 1 - side);
            }
        }
    }
}

//! Branch and bound with greedy colouring.

use super::{BitGraph, BitSet};

/// The search in one component of the complement, its vertices renumbered so that the first are those of
/// the highest degree: colouring and bits go through them in this order.
pub(super) struct Search {
    /// The largest clique so far, in the numbers of the whole graph.
    pub(super) best: Vec<usize>,
    /// Nodes visited.
    pub(super) work: u64,
    limit: u64,
    complete: bool,
    original: Vec<usize>,
    graph: BitGraph,
    root_bound: usize,
}

/// Vertices in the order of colouring, each with the number of colours used up to it.
struct Colouring {
    order: Vec<(usize, usize)>,
}

impl Search {
    pub(super) fn new(graph: &BitGraph, mut vertices: Vec<usize>, limit: u64) -> Self {
        vertices.sort_by_key(|&vertex| (std::cmp::Reverse(graph.degree(vertex)), vertex));
        let mut renumbered = BitGraph::new(vertices.len());
        for (one, &a) in vertices.iter().enumerate() {
            for (other, &b) in vertices.iter().enumerate().skip(one + 1) {
                if graph.connected(a, b) {
                    renumbered.connect(one, other);
                }
            }
        }
        Self {
            best: Vec::new(),
            work: 0,
            limit,
            complete: true,
            original: vertices,
            graph: renumbered,
            root_bound: 0,
        }
    }

    /// A proved bound: the size of the best clique once the search is complete, else the colours at the root.
    pub(super) fn upper_bound(&self) -> usize {
        if self.complete { self.best.len() } else { self.root_bound }
    }

    pub(super) fn run(&mut self) {
        let mut all = BitSet::new(self.graph.len());
        (0..self.graph.len()).for_each(|vertex| all.insert(vertex));
        self.root_bound = self.colour(&all, 0).order.last().map_or(0, |&(_, colours)| colours);
        self.greedy(&all);
        let mut clique = Vec::new();
        self.expand(&mut clique, &all);
    }

    /// A first clique: the candidate with most neighbours among the candidates, again and again.
    fn greedy(&mut self, all: &BitSet) {
        let mut candidates = all.clone();
        let mut clique = Vec::new();
        let mut common = BitSet::new(self.graph.len());
        loop {
            let most = candidates.members().max_by_key(|&vertex| {
                common.copy_from(&candidates);
                common.intersect(self.graph.neighbours(vertex));
                (common.count(), std::cmp::Reverse(vertex))
            });
            let Some(vertex) = most else { break };
            clique.push(vertex);
            candidates.intersect(self.graph.neighbours(vertex));
        }
        self.keep(&clique);
    }

    fn keep(&mut self, clique: &[usize]) {
        self.best = clique.iter().map(|&vertex| self.original[vertex]).collect();
    }

    fn expand(&mut self, clique: &mut Vec<usize>, candidates: &BitSet) {
        if self.work >= self.limit {
            self.complete = false;
            return;
        }
        self.work += 1;
        let needed = (self.best.len() + 1).saturating_sub(clique.len());
        let colouring = self.colour(candidates, needed);
        let mut candidates = candidates.clone();
        let mut next = BitSet::new(self.graph.len());
        // Those coloured last need the most colours: a clique through them can be largest.
        for &(vertex, colours) in colouring.order.iter().rev() {
            if clique.len() + colours <= self.best.len() {
                return;
            }
            clique.push(vertex);
            next.copy_from(&candidates);
            next.intersect(self.graph.neighbours(vertex));
            if !next.is_empty() {
                self.expand(clique, &next);
            } else if clique.len() > self.best.len() {
                let found = clique.clone();
                self.keep(&found);
            }
            clique.pop();
            candidates.remove(vertex);
            if !self.complete {
                return;
            }
        }
    }

    /// Colours vertices so that neighbours differ; a clique needs as many colours as it has vertices. Those
    /// that fit into fewer than `needed` colours cannot lead to a larger clique and are not listed.
    fn colour(&self, candidates: &BitSet, needed: usize) -> Colouring {
        let mut order = Vec::new();
        let mut uncoloured = candidates.clone();
        let mut class = BitSet::new(self.graph.len());
        let mut colours = 0;
        while !uncoloured.is_empty() {
            colours += 1;
            class.copy_from(&uncoloured);
            while let Some(vertex) = class.first() {
                class.remove(vertex);
                uncoloured.remove(vertex);
                class.subtract(self.graph.neighbours(vertex));
                if colours >= needed {
                    order.push((vertex, colours));
                }
            }
        }
        Colouring { order }
    }
}

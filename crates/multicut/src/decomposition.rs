//! Reductions and independent parts, alternated until only kernels remain.

use crate::blocks::split;
use crate::budget::Budget;
use crate::reduction::{DegreeTwo, History, Step, lift, reduce};
use crate::signed_graph::SignedGraph;
use crate::sum::Sum;
use crate::union_find::UnionFind;

/// A kernel: biconnected, with both signs, and irreducible.
#[derive(Debug)]
pub(crate) struct Piece {
    /// Names of its nodes in the graph that was decomposed.
    pub(crate) names: Vec<u32>,
    pub(crate) graph: SignedGraph,
}

/// What is left of a graph, and how to get back.
#[derive(Debug)]
pub(crate) struct Decomposition {
    joined: UnionFind,
    undo: Vec<DegreeTwo>,
    /// What every solution pays outside the kernels.
    pub(crate) constant: f64,
    pub(crate) kernels: Vec<Piece>,
    /// The reductions made, in order, where asked for.
    pub(crate) steps: Option<Vec<Step>>,
}

/// Reduces a graph, splits it into blocks, reduces those, and so on to a fixpoint.
pub(crate) fn decompose(graph: SignedGraph, record: bool, budget: &mut Budget) -> Decomposition {
    let node_count = graph.node_count();
    let mut joined = UnionFind::new(node_count);
    let mut undo = Vec::new();
    let mut steps = record.then(Vec::new);
    let mut constant = Sum::default();
    let mut kernels = Vec::new();
    let mut place = vec![u32::MAX; node_count];
    let mut work = vec![(Piece { names: (0..node_count as u32).collect(), graph }, false)];
    while let Some((mut piece, is_block)) = work.pop() {
        let mut left = 0.0;
        let mut history = History { joined: &mut joined, undo: &mut undo, steps: steps.as_mut() };
        let changed = reduce(&mut piece.graph, &piece.names, &mut left, &mut history, budget);
        constant.add(left);
        if is_block && !changed {
            kernels.push(piece);
            continue;
        }
        let parts = split(&piece.graph);
        constant.add(parts.constant);
        for (tail, head) in parts.joined {
            joined.union(piece.names[tail as usize], piece.names[head as usize]);
        }
        for nodes in parts.conflicted.iter().rev() {
            let names = nodes.iter().map(|&node| piece.names[node as usize]).collect();
            work.push((Piece { names, graph: piece.graph.induced(nodes, &mut place) }, true));
        }
    }
    Decomposition { joined, undo, constant: constant.value(), kernels, steps }
}

impl Decomposition {
    /// A labelling of the decomposed graph from one labelling a kernel.
    pub(crate) fn assemble<'a>(&self, labels: impl IntoIterator<Item = &'a [u32]>) -> Vec<u32> {
        let mut joined = self.joined.clone();
        for (piece, labels) in self.kernels.iter().zip(labels) {
            for (tail, head, _) in piece.graph.edges() {
                if labels[tail as usize] == labels[head as usize] {
                    joined.union(piece.names[tail as usize], piece.names[head as usize]);
                }
            }
        }
        lift(&mut joined, &self.undo);
        joined.labels()
    }
}

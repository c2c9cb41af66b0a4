//! Reductions and splits into independent blocks, alternated until only kernels remain.

use super::blocks::split;
use super::reduction::{DegreeTwo, History, Step, lift, reduce};
use crate::bound::packing::{Packed, pack_completely};
use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::sum::Sum;
use crate::graph::union_find::UnionFind;

/// A kernel: biconnected, with both signs, and irreducible.
#[derive(Debug)]
pub(crate) struct Piece {
    /// Names of its nodes in the graph that was decomposed.
    pub(crate) names: Vec<u32>,
    pub(crate) graph: SignedGraph,
}

/// The kernels of a graph, and what is needed to extend their solutions to the whole graph.
#[derive(Debug)]
pub(crate) struct Decomposition {
    joined: UnionFind,
    undo: Vec<DegreeTwo>,
    /// The cost of every solution outside the kernels.
    pub(crate) constant: f64,
    pub(crate) kernels: Vec<Piece>,
    /// The steps taken, if recorded.
    pub(crate) trace: Option<Vec<Trace>>,
}

/// The steps on one part of a graph, for a certificate.
#[derive(Debug, Clone)]
pub(crate) struct Trace {
    /// The part that it was split from, which comes earlier in the list.
    pub(crate) parent: Option<usize>,
    pub(crate) names: Vec<u32>,
    pub(crate) steps: Vec<Step>,
    /// The index of its kernel, if it is one.
    pub(crate) kernel: Option<usize>,
    /// The cycles that pack all its repulsion, if it was joined for this reason; nodes are positions in `names`.
    pub(crate) packed: Option<Vec<Packed>>,
}

/// Reduces a graph, splits it into blocks, reduces these, and repeats until nothing changes.
pub(crate) fn decompose(graph: SignedGraph, record: bool, budget: &mut Budget) -> Decomposition {
    let node_count = graph.node_count();
    let mut joined = UnionFind::new(node_count);
    let mut undo = Vec::new();
    let mut trace = record.then(Vec::new);
    let mut constant = Sum::default();
    let mut kernels = Vec::new();
    let mut place = vec![u32::MAX; node_count];
    let mut work = vec![(Piece { names: (0..node_count as u32).collect(), graph }, None)];
    while let Some((mut piece, parent)) = work.pop() {
        if budget.is_over() {
            // The budget is over: keep the piece as a kernel.
            if let Some(trace) = &mut trace {
                let (names, kernel) = (piece.names.clone(), Some(kernels.len()));
                trace.push(Trace { parent, names, steps: Vec::new(), kernel, packed: None });
            }
            kernels.push(piece);
            continue;
        }
        let mut left = 0.0;
        let index = trace.as_ref().map_or(0, Vec::len);
        if let Some(cycles) = pack_completely(&piece.graph, budget) {
            for (tail, head, _) in piece.graph.edges().filter(|edge| edge.2 > 0.0) {
                joined.union(piece.names[tail as usize], piece.names[head as usize]);
            }
            if let Some(trace) = &mut trace {
                let (names, packed) = (piece.names, Some(cycles));
                trace.push(Trace { parent, names, steps: Vec::new(), kernel: None, packed });
            }
            continue;
        }
        let mut steps = record.then(Vec::new);
        let mut history = History { joined: &mut joined, undo: &mut undo, steps: steps.as_mut() };
        let changed = reduce(&mut piece.graph, &piece.names, &mut left, &mut history, budget);
        constant.add(left);
        let is_kernel = parent.is_some() && !changed;
        if let (Some(trace), Some(steps)) = (&mut trace, steps) {
            let kernel = is_kernel.then_some(kernels.len());
            let names = piece.names.clone();
            trace.push(Trace { parent, names, steps, kernel, packed: None });
        }
        if is_kernel {
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
            work.push((Piece { names, graph: piece.graph.take(nodes, &mut place) }, Some(index)));
        }
    }
    Decomposition { joined, undo, constant: constant.value(), kernels, trace }
}

impl Decomposition {
    /// For each node of the decomposed graph, the kernel that it is in, and which node of the kernel it became. A node can be in
    /// several kernels, as the blocks of a graph share nodes; it counts in the last one.
    pub(crate) fn images(&self) -> Vec<Option<(u32, u32)>> {
        let mut joined = self.joined.clone();
        let mut images = vec![None; joined.len()];
        for (kernel, piece) in self.kernels.iter().enumerate() {
            for (at, &name) in piece.names.iter().enumerate() {
                images[joined.find(name) as usize] = Some((kernel as u32, at as u32));
            }
        }
        (0..images.len() as u32).map(|node| images[joined.find(node) as usize]).collect()
    }

    /// A labelling of the decomposed graph from one labelling of each kernel.
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

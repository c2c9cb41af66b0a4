//! The block-sparse normal equations of a connected graph whose first nodes are held.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::{Simd, WithSimd};
use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_geometry::lanes::WIDTH;

use crate::model::prior::Prior;
use crate::model::problem::Edge;
use crate::model::quadratic::{Gradient, Linearised};
use crate::model::term::Term;
use posecut_cholesky::instructions::for_small_blocks;
use posecut_cholesky::{Matrix, Memory, Symbolic};

/// Positions of an edge's blocks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    /// Variable of `from`, or `None` if it is held.
    pub(crate) from: Option<usize>,
    /// Variable of `to`, or `None` if it is held.
    pub(crate) to: Option<usize>,
    /// Off-diagonal block shared by all edges between the two, if neither is held.
    pub(crate) pair: usize,
    /// Whether the edge is the first of those: it overwrites the block, to which the others add.
    opens: bool,
}

/// Pattern of the equations, shared by every block size.
#[derive(Debug)]
pub(crate) struct Pattern {
    /// Number of held nodes, which come first. Variable v is node `held + v`.
    pub(crate) held: usize,
    pub(crate) variables: usize,
    /// The two variables of each off-diagonal block, smaller first.
    pub(crate) pairs: Vec<(usize, usize)>,
    pub(crate) slots: Vec<Slot>,
    pub(crate) symbolic: Symbolic,
}

impl Pattern {
    /// Pattern of edges over `nodes` nodes, of which the first `held` are given.
    pub(crate) fn of<G, const DOF: usize>(nodes: usize, held: usize, edges: &[Edge<G, DOF>]) -> Self {
        let variables = nodes.saturating_sub(held);
        let (pairs, slots) = number_pairs(variables, held, edges);
        let symbolic = Symbolic::new(variables, &pairs, DOF);
        Self { held, variables, pairs, slots, symbolic }
    }
}

/// The pairs of variables that edges join, sorted, and the positions of the edges' blocks. A bucket sort: O(nodes + edges) as long as
/// nodes have few neighbours.
fn number_pairs<G, const DOF: usize>(
    variables: usize,
    held: usize,
    edges: &[Edge<G, DOF>],
) -> (Vec<(usize, usize)>, Vec<Slot>) {
    let mut slots: Vec<Slot> = edges
        .iter()
        .map(|edge| Slot {
            from: edge.from.checked_sub(held),
            to: edge.to.checked_sub(held),
            pair: usize::MAX,
            opens: false,
        })
        .collect();
    let joined = |slot: &Slot| Some((slot.from?.min(slot.to?), slot.from?.max(slot.to?)));
    let arcs = slots
        .iter()
        .enumerate()
        .filter_map(|(edge, slot)| joined(slot).map(|(smaller, larger)| (smaller, (larger, edge))));
    let mut starts = vec![0; variables + 1];
    arcs.clone().for_each(|(smaller, _)| starts[smaller + 1] += 1);
    for variable in 0..variables {
        starts[variable + 1] += starts[variable];
    }
    let mut buckets = vec![(0, 0); starts[variables]];
    let mut next = starts.clone();
    for (smaller, arc) in arcs {
        buckets[next[smaller]] = arc;
        next[smaller] += 1;
    }
    let mut pairs = Vec::with_capacity(buckets.len());
    for smaller in 0..variables {
        let bucket = &mut buckets[starts[smaller]..starts[smaller + 1]];
        bucket.sort_unstable();
        for &(larger, edge) in &*bucket {
            if pairs.last() != Some(&(smaller, larger)) {
                pairs.push((smaller, larger));
                slots[edge].opens = true;
            }
            slots[edge].pair = pairs.len() - 1;
        }
    }
    (pairs, slots)
}

/// Values of the equations: `H d = -g`.
#[derive(Debug)]
pub(crate) struct NormalEquations<const D: usize> {
    pub(crate) diagonal: Vec<SMatrix<f64, D, D>>,
    /// Block of pair (a, b), a < b: row a, column b.
    pub(crate) off_diagonal: Vec<SMatrix<f64, D, D>>,
    pub(crate) gradient: Vec<SVector<f64, D>>,
}

impl<const D: usize> NormalEquations<D> {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        Self {
            diagonal: vec![SMatrix::zeros(); pattern.variables],
            off_diagonal: vec![SMatrix::zeros(); pattern.pairs.len()],
            gradient: vec![SVector::zeros(); pattern.variables],
        }
    }

    /// Prepares for the blocks of all edges, in their order. The first edge of each off-diagonal block overwrites it.
    pub(crate) fn clear(&mut self) {
        self.diagonal.fill(SMatrix::zeros());
        self.gradient.fill(SVector::zeros());
    }

    /// Adds a block at (from, to).
    #[inline(always)]
    pub(crate) fn add_off_diagonal(&mut self, slot: &Slot, block: &SMatrix<f64, D, D>) {
        let (Some(from), Some(to)) = (slot.from, slot.to) else { return };
        let sum = &mut self.off_diagonal[slot.pair];
        match (slot.opens, from < to) {
            (true, true) => *sum = *block,
            (true, false) => *sum = block.transpose(),
            (false, true) => add_to(sum, block),
            (false, false) => add_to(sum, &block.transpose()),
        }
    }

    /// Linearises all edges, in their order, and returns the cost.
    pub(crate) fn assemble<G: LieGroup<D>, T: Term<G, D>>(
        &mut self,
        pattern: &Pattern,
        edges: &[T],
        poses: &[G],
    ) -> f64 {
        self.clear();
        // Uses vector instructions of the machine for everything that is inlined below.
        for_small_blocks(Assemble { equations: self, pattern, edges, poses })
    }

    /// [`assemble`](Self::assemble) with the exact second derivative.
    pub(crate) fn assemble_exactly<G: LieGroup<D>, T: Term<G, D>>(
        &mut self,
        pattern: &Pattern,
        edges: &[T],
        poses: &[G],
    ) -> f64 {
        self.clear();
        let mut cost = 0.0;
        for (edge, slot) in edges.iter().zip(&pattern.slots) {
            let model = edge.curve(poses);
            cost += model.cost;
            self.add(slot, &model);
        }
        cost
    }

    /// Adds the model of an edge.
    #[inline(always)]
    fn add(&mut self, slot: &Slot, model: &Linearised<D>) {
        if let Some(from) = slot.from {
            add_to(&mut self.diagonal[from], &model.from_from);
            self.gradient[from] += model.from_gradient;
        }
        if let Some(to) = slot.to {
            add_to(&mut self.diagonal[to], &model.to_to);
            self.gradient[to] += model.to_gradient;
        }
        self.add_off_diagonal(slot, &model.from_to);
    }

    /// Computes only the gradient and the cost; the matrix stays the same.
    pub(crate) fn assemble_gradient<G: LieGroup<D>, T: Term<G, D>>(
        &mut self,
        pattern: &Pattern,
        edges: &[T],
        poses: &[G],
    ) -> f64 {
        self.gradient.fill(SVector::zeros());
        for_small_blocks(AssembleGradient { gradient: &mut self.gradient, pattern, edges, poses })
    }

    /// `H d`.
    pub(crate) fn times(&self, pattern: &Pattern, d: &[SVector<f64, D>]) -> Vec<SVector<f64, D>> {
        self.damped((0.0, [0.0; D])).times(&pattern.pairs, d)
    }

    /// The matrix with this damping and floor.
    pub(crate) fn damped(&self, (damping, floor): (f64, [f64; D])) -> Matrix<'_, D> {
        let Self { diagonal, off_diagonal, .. } = self;
        Matrix { diagonal, off_diagonal, damping, floor }
    }

    /// Adds priors to the equations, of which the first `held` nodes have no variables, and returns the cost with theirs.
    pub(crate) fn add_priors<G: LieGroup<D>>(
        &mut self,
        held: usize,
        priors: &[Prior<G, D>],
        poses: &[G],
        mut cost: f64,
    ) -> f64 {
        for prior in priors {
            let model = prior.linearise(&poses[prior.node]);
            cost += model.cost;
            if let Some(variable) = prior.node.checked_sub(held) {
                self.diagonal[variable] += model.block;
                self.gradient[variable] += model.gradient;
            }
        }
        cost
    }

    /// Adds the gradients of priors, and returns the cost with theirs.
    pub(crate) fn add_prior_gradients<G: LieGroup<D>>(
        &mut self,
        held: usize,
        priors: &[Prior<G, D>],
        poses: &[G],
        mut cost: f64,
    ) -> f64 {
        for prior in priors {
            let model = prior.linearise(&poses[prior.node]);
            cost += model.cost;
            if let Some(variable) = prior.node.checked_sub(held) {
                self.gradient[variable] += model.gradient;
            }
        }
        cost
    }

    /// `d^T H d`.
    pub(crate) fn curvature(&self, pattern: &Pattern, step: &[SVector<f64, D>]) -> f64 {
        let own: f64 = self.diagonal.iter().zip(step).map(|(block, step)| step.dot(&(block * step))).sum();
        let blocks = self.off_diagonal.iter().zip(&pattern.pairs);
        own + 2.0 * blocks.map(|(block, &(a, b))| step[a].dot(&(block * step[b]))).sum::<f64>()
    }

    /// The largest `g_k^2 / H_kk`: the largest decrease of the cost by a single component.
    pub(crate) fn steepest(&self) -> f64 {
        let ratio = |(gradient, diagonal): (f64, f64)| {
            if gradient == 0.0 { 0.0 } else { gradient * (gradient / diagonal) }
        };
        self.gradient
            .iter()
            .zip(&self.diagonal)
            .flat_map(|(gradient, block)| (0..D).map(|axis| (gradient[axis], block[(axis, axis)])))
            .map(ratio)
            .fold(0.0, f64::max)
    }
}

/// `to += block`, inlined into its caller, which the operator is not.
#[inline(always)]
fn add_to<const D: usize>(to: &mut SMatrix<f64, D, D>, block: &SMatrix<f64, D, D>) {
    for (sum, value) in to.as_mut_slice().iter_mut().zip(block.as_slice()) {
        *sum += value;
    }
}

/// A pattern, its equations, and memory for their factor.
#[derive(Debug)]
pub(crate) struct System<const D: usize> {
    pub(crate) pattern: Pattern,
    pub(crate) equations: NormalEquations<D>,
    pub(crate) memory: Memory,
}

impl<const D: usize> System<D> {
    pub(crate) fn new(pattern: Pattern, memory: Memory) -> Self {
        let equations = NormalEquations::new(&pattern);
        Self { pattern, equations, memory }
    }
}

/// [`NormalEquations::assemble`] for one set of vector instructions. Not a closure: a closure would not be inlined.
struct Assemble<'a, G, T, const D: usize> {
    equations: &'a mut NormalEquations<D>,
    pattern: &'a Pattern,
    edges: &'a [T],
    poses: &'a [G],
}

impl<G: LieGroup<D>, T: Term<G, D>, const D: usize> WithSimd for Assemble<'_, G, T, D> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { equations, pattern, edges, poses } = self;
        let mut cost = 0.0;
        let mut models = [Linearised::zero(); WIDTH];
        for (edges, slots) in edges.chunks(S::F64_LANES).zip(pattern.slots.chunks(S::F64_LANES)) {
            if !T::models(simd, edges, poses, &mut models[..edges.len()]) {
                for (edge, model) in edges.iter().zip(&mut models) {
                    *model = edge.linearise(poses);
                }
            }
            for (model, slot) in models.iter().zip(slots) {
                cost += model.cost;
                equations.add(slot, model);
            }
        }
        cost
    }
}

/// [`NormalEquations::assemble_gradient`] in the same way.
struct AssembleGradient<'a, G, T, const D: usize> {
    gradient: &'a mut [SVector<f64, D>],
    pattern: &'a Pattern,
    edges: &'a [T],
    poses: &'a [G],
}

impl<G: LieGroup<D>, T: Term<G, D>, const D: usize> WithSimd for AssembleGradient<'_, G, T, D> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { gradient, pattern, edges, poses } = self;
        let mut cost = 0.0;
        let mut models = [Gradient::zero(); WIDTH];
        for (edges, slots) in edges.chunks(S::F64_LANES).zip(pattern.slots.chunks(S::F64_LANES)) {
            if !T::gradients(simd, edges, poses, &mut models[..edges.len()]) {
                for (edge, model) in edges.iter().zip(&mut models) {
                    *model = edge.gradient(poses);
                }
            }
            for (model, slot) in models.iter().zip(slots) {
                cost += model.cost;
                if let Some(from) = slot.from {
                    gradient[from] += model.from;
                }
                if let Some(to) = slot.to {
                    gradient[to] += model.to;
                }
            }
        }
        cost
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::problem::EdgeKind;
    use nalgebra::Matrix3;
    use posecut_geometry::SE2;

    /// Three edges between the same two poses, one of them against the others, and equations that hold another graph's values before.
    #[test]
    fn parallel_edges_add_up_whatever_the_equations_held_before() {
        let poses = [SE2::new(0.0, 0.0, 0.2), SE2::new(1.0, 0.5, 0.9), SE2::new(2.0, 0.1, -0.4)];
        let edge = |from: usize, to: usize, weight: f64| {
            let measured = poses[from].between(&poses[to]).compose(&SE2::new(0.1, -0.05, 0.02));
            Edge::new(from, to, measured, Matrix3::identity() * weight, EdgeKind::Landmark)
        };
        let edges = [edge(0, 1, 1.0), edge(1, 2, 2.0), edge(2, 1, 3.0), edge(1, 2, 4.0)];
        let pattern = Pattern::of(3, 1, &edges);
        let mut equations = NormalEquations::new(&pattern);
        equations.off_diagonal.fill(SMatrix::repeat(1e9));
        for _ in 0..2 {
            equations.assemble(&pattern, &edges, &poses);
            let models: Vec<_> = edges.iter().map(|edge| edge.linearise(&poses)).collect();
            let between = models[1].from_to + models[2].from_to.transpose() + models[3].from_to;
            assert!((equations.off_diagonal[0] - between).amax() < 1e-13, "{}", equations.off_diagonal[0]);
            let second = models[1].to_to + models[2].from_from + models[3].to_to;
            assert!((equations.diagonal[1] - second).amax() < 1e-13);
        }
    }
}

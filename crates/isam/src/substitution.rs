//! Back-substitution through the tree, as far as something changes.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::SVector;
use posecut_cholesky::fronts::products;
use posecut_geometry::LieGroup;
use pulp::{Simd, WithSimd};

use crate::UpdateReport;
use crate::estimate::Estimate;
use crate::movement::Movement;
use crate::tree::{Clique, Tree};
use posecut_cholesky::instructions::for_small_blocks;

/// Number of partial sums: the lanes of one vector register.
const LANES: usize = 4;

/// Solves a clique for its frontal variables: `x_1 = L^-T (y - M^T x_2)`.
#[inline(always)]
fn solve<const D: usize>(clique: &Clique, values: &[SVector<f64, D>], known: &mut Vec<f64>) {
    // `known` runs over the rows of a column: first the frontal scalars, then the separator's.
    let rows = clique.variables.len() * D;
    let height = rows + 1;
    known.clear();
    known.resize(rows, 0.0);
    for (target, &node) in known.chunks_exact_mut(D).zip(&clique.variables).skip(clique.frontals) {
        target.copy_from_slice(values[node].as_slice());
    }
    for (place, block) in clique.panel.chunks_exact(D * height).enumerate().rev() {
        let start = place * D;
        let (own, later) = known[start..].split_at_mut(D);
        let sources: [&[f64]; D] =
            std::array::from_fn(|column| &block[column * height + start + D..][..later.len()]);
        let sums = products::<D, LANES, f64>(&sources, later);
        for column in (0..D).rev() {
            let entries = &block[column * height..][..height];
            let mut rest = entries[rows] - sums[column];
            for other in column + 1..D {
                rest -= entries[start + other] * own[other];
            }
            own[column] = rest / entries[start + column];
        }
    }
}

/// The cliques that a solution visits.
pub(crate) struct Below<'a> {
    /// New cliques, children before parents: all are solved.
    pub(crate) made: &'a [usize],
    /// Roots of the subtrees below them. A subtree is solved only as far as its separators change.
    pub(crate) orphans: Vec<usize>,
    /// Changes up to this are not propagated, metres and radians.
    pub(crate) threshold: f64,
}

/// What back-substitution keeps from one solution to the next.
#[derive(Debug, Default)]
pub(crate) struct Substitution<const DOF: usize> {
    /// Linear updates with which the subtrees below were last solved.
    propagated: Vec<SVector<f64, DOF>>,
    /// The last solution that changed a node's linear update by more than the threshold.
    changed: Vec<usize>,
    solutions: usize,
    /// The scalars of a clique while it is solved.
    known: Vec<f64>,
}

impl<const DOF: usize> Substitution<DOF> {
    pub(crate) fn add_node(&mut self) {
        self.propagated.push(SVector::zeros());
        self.changed.push(0);
    }

    /// Notes that a pose was relinearised: its linear update is zero.
    pub(crate) fn reset(&mut self, node: usize) {
        self.propagated[node] = SVector::zeros();
    }

    /// Solves the new cliques, and the subtrees below them only as far as their separators change.
    pub(crate) fn solve<G: LieGroup<DOF>>(
        &mut self,
        below: Below<'_>,
        tree: &Tree,
        estimate: &mut Estimate<G, DOF>,
        movement: &mut Movement<DOF>,
        report: &mut UpdateReport,
    ) {
        self.solutions += 1;
        for_small_blocks(Solve { substitution: self, below, tree, estimate, movement, report });
    }
}

/// Substitution for one set of vector instructions. Not a closure: a closure would not be inlined, and the functions it calls
/// would be compiled for the baseline instruction set.
struct Solve<'a, G, const DOF: usize> {
    substitution: &'a mut Substitution<DOF>,
    below: Below<'a>,
    tree: &'a Tree,
    estimate: &'a mut Estimate<G, DOF>,
    movement: &'a mut Movement<DOF>,
    report: &'a mut UpdateReport,
}

impl<G: LieGroup<DOF>, const DOF: usize> Solve<'_, G, DOF> {
    #[inline(always)]
    fn clique(&mut self, index: usize) {
        let mut known = std::mem::take(&mut self.substitution.known);
        let clique = self.tree.clique(index);
        solve(clique, &self.estimate.deltas, &mut known);
        self.report.solved += clique.frontals;
        for (&node, values) in clique.variables.iter().zip(known.chunks_exact(DOF)).take(clique.frontals) {
            self.take(node, SVector::from_column_slice(values));
        }
        self.substitution.known = known;
    }

    /// Stores a new linear update of a variable, and notes whether subtrees below have to follow and whether the pose has
    /// moved far.
    #[inline(always)]
    fn take(&mut self, node: usize, value: SVector<f64, DOF>) {
        let Substitution { propagated, changed, solutions, .. } = &mut *self.substitution;
        self.estimate.deltas[node] = value;
        if (value - propagated[node]).amax() > self.below.threshold {
            propagated[node] = value;
            changed[node] = *solutions;
        }
        self.movement.note(node, &value);
    }
}

impl<G: LieGroup<DOF>, const DOF: usize> WithSimd for Solve<'_, G, DOF> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        for &index in self.below.made.iter().rev() {
            self.clique(index);
        }
        let mut pending = std::mem::take(&mut self.below.orphans);
        while let Some(index) = pending.pop() {
            let clique = self.tree.clique(index);
            let Substitution { changed, solutions, .. } = &*self.substitution;
            let mut separator = clique.variables[clique.frontals..].iter();
            if separator.any(|&node| changed[node] == *solutions) {
                pending.extend_from_slice(&clique.children);
                self.clique(index);
            }
        }
    }
}

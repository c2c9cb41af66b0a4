//! Back-substitution through the tree, as far as something changes.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::{Arch, Simd, WithSimd};
use nalgebra::SVector;
use posecut_cholesky::fronts::products;
use posecut_optimize::PoseGroup;

use crate::tree::Clique;
use crate::{IncrementalSolver, UpdateReport};

/// Lanes of a sum: one vector register.
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
        let sums = products::<D, LANES>(&sources, later);
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

impl<G: PoseGroup<DOF>, const DOF: usize> IncrementalSolver<G, DOF> {
    /// Solves the new cliques, and the subtrees below them as far as their separators change.
    pub(crate) fn substitute(
        &mut self,
        made: &[usize],
        orphans: Vec<usize>,
        threshold: f64,
        report: &mut UpdateReport,
    ) {
        self.solutions += 1;
        Arch::new().dispatch(Substitute { solver: self, made, orphans, threshold, report });
    }

    #[inline(always)]
    fn solve_clique(&mut self, index: usize, threshold: f64, report: &mut UpdateReport) {
        let mut known = std::mem::take(&mut self.known);
        let clique = self.tree.clique(index);
        solve(clique, &self.estimate.deltas, &mut known);
        let frontals = clique.frontals;
        report.solved += frontals;
        for (place, values) in known.chunks_exact(DOF).take(frontals).enumerate() {
            let node = self.tree.clique(index).variables[place];
            self.take_value(node, SVector::from_column_slice(values), threshold);
        }
        self.known = known;
    }
}

/// Substitution for one set of vector instructions. Not a closure: the call of one is not inlined, and what it calls would
/// be compiled for the least of all machines.
struct Substitute<'a, G, const DOF: usize> {
    solver: &'a mut IncrementalSolver<G, DOF>,
    made: &'a [usize],
    orphans: Vec<usize>,
    threshold: f64,
    report: &'a mut UpdateReport,
}

impl<G: PoseGroup<DOF>, const DOF: usize> WithSimd for Substitute<'_, G, DOF> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { solver, made, orphans, threshold, report } = self;
        for &index in made.iter().rev() {
            solver.solve_clique(index, threshold, report);
        }
        let mut pending = orphans;
        while let Some(index) = pending.pop() {
            let clique = solver.tree.clique(index);
            let mut separator = clique.variables[clique.frontals..].iter();
            if separator.any(|&node| solver.changed[node] == solver.solutions) {
                pending.extend_from_slice(&clique.children);
                solver.solve_clique(index, threshold, report);
            }
        }
    }
}

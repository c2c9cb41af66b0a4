//! Back-substitution through the tree, as far as something changes.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::SVector;

use super::tree::Clique;

/// Lanes of a sum: as many as one vector instruction of any machine takes.
const LANES: usize = 8;

/// Solves a clique for its frontal variables: `x_1 = L^-T (y - M^T x_2)`. `known` is working memory.
#[inline(always)]
pub(super) fn solve<const D: usize>(clique: &Clique, values: &[SVector<f64, D>], known: &mut Vec<f64>) {
    // `known` runs over the rows of a column: first the frontal scalars, then the separator's.
    let rows = clique.variables.len() * D;
    let (height, columns) = (rows + 1, clique.frontals * D);
    known.clear();
    known.resize(rows, 0.0);
    for (target, &node) in known.chunks_exact_mut(D).zip(&clique.variables).skip(clique.frontals) {
        target.copy_from_slice(values[node].as_slice());
    }
    for column in (0..columns).rev() {
        let entries = &clique.panel[column * height..][..height];
        let sum = dot(&entries[column + 1..rows], &known[column + 1..]);
        known[column] = (entries[rows] - sum) / entries[column];
    }
}

#[inline(always)]
fn dot(first: &[f64], second: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let (mut left, mut right) = (first.chunks_exact(LANES), second.chunks_exact(LANES));
    for (a, b) in left.by_ref().zip(right.by_ref()) {
        for lane in 0..LANES {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = left.remainder().iter().zip(right.remainder()).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

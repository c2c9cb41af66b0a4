//! `M` of SE-Sync's cost `F = tr(X M X^T)`, and its factors.

use std::ops::AddAssign as _;

use nalgebra::{SMatrix, SVector};

use super::chordal_cost::ChordalEdge;
use posecut_cholesky::{Factor, Symbolic};

/// `M` by blocks (translation, rotation) of poses; the first translation is held at zero.
pub(crate) struct ChordalMatrix<const M: usize> {
    pub(crate) symbolic: Symbolic,
    /// The two nodes of each block off the diagonal, smaller first.
    pub(crate) pairs: Vec<(usize, usize)>,
    pub(crate) diagonal: Vec<SMatrix<f64, M, M>>,
    pub(crate) off_diagonal: Vec<SMatrix<f64, M, M>>,
}

impl<const M: usize> ChordalMatrix<M> {
    /// The matrix of these terms. O(terms log terms), plus the analysis of the factor.
    pub(crate) fn new<const N: usize>(nodes: usize, terms: &[ChordalEdge<N>]) -> Self {
        let ends = |term: &ChordalEdge<N>| (term.from.min(term.to), term.from.max(term.to));
        let mut pairs: Vec<_> = terms.iter().map(ends).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut diagonal = vec![SMatrix::<f64, M, M>::zeros(); nodes];
        let mut off_diagonal = vec![SMatrix::<f64, M, M>::zeros(); pairs.len()];
        for term in terms {
            let (from, between, to) = blocks::<N, M>(term);
            diagonal[term.from] += from;
            diagonal[term.to] += to;
            if let Ok(index) = pairs.binary_search(&ends(term)) {
                off_diagonal[index] += if term.from < term.to { between } else { between.transpose() };
            }
        }
        hold(&mut diagonal[0]);
        for (block, _) in off_diagonal.iter_mut().zip(&pairs).filter(|(_, pair)| pair.0 == 0) {
            block.row_mut(0).fill(0.0);
        }
        let symbolic = Symbolic::new(nodes, &pairs, M);
        Self { symbolic, pairs, diagonal, off_diagonal }
    }

    /// The largest diagonal entry of a rotation. Translations do not count: they have another unit, and the first one is held
    /// by a 1.
    pub(crate) fn largest(&self) -> f64 {
        let rotations =
            |block: &SMatrix<f64, M, M>| (1..M).map(|axis| block[(axis, axis)].abs()).fold(0.0, f64::max);
        self.diagonal.iter().map(rotations).fold(0.0, f64::max)
    }

    /// Factorises with the shift added to the rotations; returns whether the matrix is positive definite.
    pub(crate) fn factorize(&self, factor: &mut Factor<M>, shift: f64) -> bool {
        let mut shifted = self.diagonal.clone();
        for block in &mut shifted {
            for axis in 1..M {
                block[(axis, axis)] += shift;
            }
        }
        factor.factorize(&self.symbolic, &shifted, &self.off_diagonal, 0.0, [0.0; M]).is_ok()
    }
}

/// The blocks (i, i), (i, j) and (j, j) of `kappa |R_j - R_i Z|^2 + tau |t_j - t_i - R_i z|^2`.
fn blocks<const N: usize, const M: usize>(
    term: &ChordalEdge<N>,
) -> (SMatrix<f64, M, M>, SMatrix<f64, M, M>, SMatrix<f64, M, M>) {
    let mut from = SMatrix::<f64, M, M>::zeros();
    let mut between = SMatrix::<f64, M, M>::zeros();
    let mut to = SMatrix::<f64, M, M>::identity() * term.kappa;
    // The row of `[t R]` that an edge's translation error multiplies: `(1, z)` at i, `(-1, 0)` at j.
    let lever = SVector::<f64, M>::from_fn(|row, _| if row == 0 { 1.0 } else { term.translation[row - 1] });
    from += lever * lever.transpose() * term.tau;
    from.fixed_view_mut::<N, N>(1, 1).add_assign(SMatrix::<f64, N, N>::identity() * term.kappa);
    between.set_column(0, &(lever * -term.tau));
    between.fixed_view_mut::<N, N>(1, 1).copy_from(&(term.rotation * -term.kappa));
    to[(0, 0)] = term.tau;
    (from, between, to)
}

/// Replaces the translation's row and column by those of the identity.
fn hold<const M: usize>(block: &mut SMatrix<f64, M, M>) {
    block.row_mut(0).fill(0.0);
    block.column_mut(0).fill(0.0);
    block[(0, 0)] = 1.0;
}

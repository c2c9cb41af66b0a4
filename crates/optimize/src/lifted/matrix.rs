//! `M` of `F = tr(X M X^T)`, its products, and a factor near it.

use std::ops::AddAssign as _;

use nalgebra::{SMatrix, SVector};
use posecut_cholesky::{Factor, Symbolic};

use super::manifold::Lift;
use crate::certificate::chordal_cost::ChordalEdge;

/// Share of the largest entry that is added to the rotations before the factorisation. `M` alone is nearly singular where edges
/// agree, and its inverse would hide which rotations they hold.
const SHIFT: f64 = 1e-3;

/// `M` by blocks (translation, rotation) of poses; the first translation is held at zero.
pub(super) struct ChordalMatrix<const M: usize> {
    symbolic: Symbolic,
    pairs: Vec<(usize, usize)>,
    diagonal: Vec<SMatrix<f64, M, M>>,
    off_diagonal: Vec<SMatrix<f64, M, M>>,
}

impl<const M: usize> ChordalMatrix<M> {
    /// The matrix of these terms. O(terms log terms), plus the analysis of the factor.
    pub(super) fn new<const N: usize>(nodes: usize, terms: &[ChordalEdge<N>]) -> Self {
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

    /// `X M`. O(terms).
    pub(super) fn times<const P: usize>(&self, x: &Lift<P, M>) -> Lift<P, M> {
        let mut product: Lift<P, M> = x.iter().zip(&self.diagonal).map(|(x, block)| x * block).collect();
        for (block, &(a, b)) in self.off_diagonal.iter().zip(&self.pairs) {
            product[b] += x[a] * block;
            product[a] += x[b] * block.transpose();
        }
        product[0].column_mut(0).fill(0.0);
        product
    }

    /// A factor of `M` with shifted rotations; `None` if it is singular.
    pub(super) fn factor(&self) -> Option<Factor<M>> {
        let largest = self.diagonal.iter().flat_map(|block| (1..M).map(|axis| block[(axis, axis)]));
        let shift = SHIFT * largest.fold(0.0, f64::max);
        let mut shifted = self.diagonal.clone();
        for block in &mut shifted {
            for axis in 1..M {
                block[(axis, axis)] += shift;
            }
        }
        let mut factor = Factor::new(&self.symbolic);
        factor.factorize(&self.symbolic, &shifted, &self.off_diagonal, 0.0, [0.0; M]).ok()?;
        Some(factor)
    }

    /// `R A^-1` for the matrix `A` that was factorised, row by row.
    pub(super) fn divide<const P: usize>(&self, factor: &mut Factor<M>, r: &Lift<P, M>) -> Lift<P, M> {
        let mut quotient = vec![SMatrix::<f64, P, M>::zeros(); r.len()];
        let mut row_of_all = vec![SVector::<f64, M>::zeros(); r.len()];
        for row in 0..P {
            for (to, block) in row_of_all.iter_mut().zip(r) {
                *to = block.row(row).transpose();
            }
            row_of_all[0][0] = 0.0;
            factor.solve(&self.symbolic, &mut row_of_all);
            for (block, from) in quotient.iter_mut().zip(&row_of_all) {
                block.set_row(row, &from.transpose());
            }
        }
        quotient
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

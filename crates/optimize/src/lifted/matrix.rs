//! Products and quotients of poses in more dimensions with `M` of `F = tr(X M X^T)`.

use nalgebra::{SMatrix, SVector};
use posecut_cholesky::Factor;

use super::manifold::Lift;
use crate::certificate::chordal_matrix::ChordalMatrix;

/// Share of the largest entry that is added to the rotations before the factorisation. `M` alone is nearly singular where edges
/// agree, and its inverse would hide which rotations they hold.
const SHIFT: f64 = 1e-3;

impl<const M: usize> ChordalMatrix<M> {
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
        let mut factor = Factor::new(&self.symbolic);
        self.factorize(&mut factor, SHIFT * self.largest()).then_some(factor)
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

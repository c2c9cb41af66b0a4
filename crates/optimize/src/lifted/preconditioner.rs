//! What conjugate gradients divide by: a matrix near the Hessian, and its factor.

use posecut_cholesky::Factor;

use super::manifold::{Lift, project};
use super::tangent::Tangents;
use crate::certificate::chordal_matrix::ChordalMatrix;
use crate::effort::Effort;

/// The close one serves for about that many points.
const FACTORISATIONS: usize = 10;

/// The cheap one first, the close one where that does not suffice.
pub(super) enum Preconditioner<const P: usize, const M: usize, const T: usize> {
    /// `M` on all blocks, one factor for the whole iteration. It serves where the information of all edges has about one size.
    Blocks(Box<Factor<M>>),
    /// `M` on the tangents at the point, with larger blocks and a factor for each point.
    Tangents(Box<Tangents<P, M, T>>),
}

impl<const P: usize, const M: usize, const T: usize> Preconditioner<P, M, T> {
    /// `None` if `M` is singular.
    pub(super) fn new(matrix: &ChordalMatrix<M>) -> Option<Self> {
        matrix.factor().map(|factor| Self::Blocks(Box::new(factor)))
    }

    /// Takes the close one from now on, if the effort affords it; returns whether that is a change.
    pub(super) fn come_closer(&mut self, matrix: &ChordalMatrix<M>, effort: &Effort) -> bool {
        let operations = matrix.symbolic.flops() * (T as f64 / M as f64).powi(3);
        let changes =
            matches!(self, Self::Blocks(_)) && effort.affords(operations, FACTORISATIONS) == FACTORISATIONS;
        if changes {
            *self = Self::Tangents(Box::new(Tangents::new(matrix)));
        }
        changes
    }

    /// Goes to a point; returns whether it can be factorised there.
    pub(super) fn move_to(&mut self, matrix: &ChordalMatrix<M>, x: &Lift<P, M>, effort: &mut Effort) -> bool {
        match self {
            Self::Blocks(_) => true,
            Self::Tangents(tangents) => tangents.move_to(matrix, x, effort),
        }
    }

    /// The tangent at `x` that the quotient of `r` is.
    pub(super) fn divide<const N: usize>(
        &mut self,
        matrix: &ChordalMatrix<M>,
        x: &Lift<P, M>,
        r: &Lift<P, M>,
        effort: &mut Effort,
    ) -> Lift<P, M> {
        match self {
            Self::Blocks(factor) => {
                effort.substitute(P, M * M * size_of::<f64>() * matrix.symbolic.factor_blocks());
                let mut quotient = matrix.divide(factor, r);
                project::<N, M, P>(x, &mut quotient);
                quotient
            }
            Self::Tangents(tangents) => tangents.divide(r, effort),
        }
    }
}

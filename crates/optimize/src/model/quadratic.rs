//! Quadratic and linear models of the costs of edges.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::{Matrix3, SMatrix, SVector};
use posecut_geometry::LieGroup;

/// Quadratic model of one edge's cost around the current poses, in right perturbations of its two poses.
#[derive(Clone, Copy, Debug)]
pub struct Linearised<const DOF: usize> {
    /// Block of the normal equations at (from, from).
    pub from_from: SMatrix<f64, DOF, DOF>,
    /// Block at (from, to).
    pub from_to: SMatrix<f64, DOF, DOF>,
    /// Block at (to, to).
    pub to_to: SMatrix<f64, DOF, DOF>,
    /// Half the gradient at from.
    pub from_gradient: SVector<f64, DOF>,
    /// Half the gradient at to.
    pub to_gradient: SVector<f64, DOF>,
    /// `rho(e^T Omega e)`.
    pub cost: f64,
}

impl<const DOF: usize> Linearised<DOF> {
    /// Of a term that is 0.
    pub(crate) fn zero() -> Self {
        let (block, gradient) = (SMatrix::zeros(), SVector::zeros());
        Self {
            from_from: block,
            from_to: block,
            to_to: block,
            from_gradient: gradient,
            to_gradient: gradient,
            cost: 0.0,
        }
    }

    /// The model, given the block and half the gradient in a right perturbation of `X_ij`, which equals one of `X_j`.
    #[inline(always)]
    pub fn new<G: LieGroup<DOF>>(
        relative: &G,
        to_to: SMatrix<f64, DOF, DOF>,
        to_gradient: SVector<f64, DOF>,
        cost: f64,
    ) -> Self {
        let adjoint = relative.inverse().adjoint();
        let from_gradient = -adjoint.tr_mul(&to_gradient);
        let (product, from_from) = triangular_congruence(&adjoint, &to_to);
        let from_to = -product;
        Self { from_from, from_to, to_to, from_gradient, to_gradient, cost }
    }
}

/// Linear model of one edge's cost.
#[derive(Clone, Copy, Debug)]
pub struct Gradient<const DOF: usize> {
    /// Half the gradient at from.
    pub from: SVector<f64, DOF>,
    /// Half the gradient at to.
    pub to: SVector<f64, DOF>,
    /// `rho(e^T Omega e)`.
    pub cost: f64,
}

impl<const DOF: usize> Gradient<DOF> {
    /// Of a term that is 0.
    pub(crate) fn zero() -> Self {
        Self { from: SVector::zeros(), to: SVector::zeros(), cost: 0.0 }
    }

    /// The model, given half the gradient in a right perturbation of `X_ij`, which equals one of `X_j`.
    #[inline(always)]
    pub fn new<G: LieGroup<DOF>>(relative: &G, to: SVector<f64, DOF>, cost: f64) -> Self {
        Self { from: -relative.inverse().adjoint().tr_mul(&to), to, cost }
    }
}

/// `J^T A` and `J^T A J` for symmetric `A`, where `J` is an adjoint or a Jacobian of the logarithm. In space both are
/// block-triangular, `[P, Q; 0, S]`, which saves more than half of the products.
#[inline(always)]
pub(super) fn triangular_congruence<const DOF: usize>(
    jacobian: &SMatrix<f64, DOF, DOF>,
    matrix: &SMatrix<f64, DOF, DOF>,
) -> (SMatrix<f64, DOF, DOF>, SMatrix<f64, DOF, DOF>) {
    if DOF != 6 {
        let product = jacobian.tr_mul(matrix);
        return (product, product * jacobian);
    }
    let block = |of: &SMatrix<f64, DOF, DOF>, row: usize, column: usize| -> Matrix3<f64> {
        of.fixed_view::<3, 3>(3 * row, 3 * column).into_owned()
    };
    let (p, q, s) = (block(jacobian, 0, 0), block(jacobian, 0, 1), block(jacobian, 1, 1));
    let (a, b, c) = (block(matrix, 0, 0), block(matrix, 0, 1), block(matrix, 1, 1));
    let (p_a, p_b) = (p.tr_mul(&a), p.tr_mul(&b));
    let (q_a, q_b) = (q.tr_mul(&a) + s.tr_mul(&b.transpose()), q.tr_mul(&b) + s.tr_mul(&c));
    let upper_right = p_a * q + p_b * s;
    let join = |blocks: [&Matrix3<f64>; 4]| {
        let mut joined = SMatrix::<f64, DOF, DOF>::zeros();
        for (index, from) in blocks.into_iter().enumerate() {
            joined.fixed_view_mut::<3, 3>(3 * (index / 2), 3 * (index % 2)).copy_from(from);
        }
        joined
    };
    let product = join([&p_a, &p_b, &q_a, &q_b]);
    let congruence = join([&(p_a * p), &upper_right, &upper_right.transpose(), &(q_a * q + q_b * s)]);
    (product, congruence)
}

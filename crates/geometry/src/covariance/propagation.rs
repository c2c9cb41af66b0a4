//! First-order propagation of covariances through the group's operations.
//!
//! Every covariance is that of a right perturbation, `T = T_hat Exp(xi)`. An adjoint moves a perturbation past a motion,
//! `Exp(xi) B = B Exp(Ad(B^-1) xi)`, so the formulas below contain no Jacobian of the logarithm. They neglect terms of third
//! and higher order in the standard deviations. A cross-covariance `E[a b^T]` is zero unless given.

use nalgebra::SMatrix;

use crate::lie_group::LieGroup;

/// Averages a matrix with its transpose, so that rounding does not make a covariance unsymmetric.
fn symmetric<const DOF: usize>(matrix: SMatrix<f64, DOF, DOF>) -> SMatrix<f64, DOF, DOF> {
    (matrix + matrix.transpose()) * 0.5
}

/// Covariance of `A B` for independent factors: `Ad(B^-1) Sigma_A Ad(B^-1)^T + Sigma_B`.
pub fn compose<G: LieGroup<DOF>, const DOF: usize>(
    first_covariance: &SMatrix<f64, DOF, DOF>,
    second: &G,
    second_covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    compose_correlated(first_covariance, second, second_covariance, &SMatrix::zeros())
}

/// Covariance of `A B` with the cross-covariance `C = E[a b^T]`:
/// `D Sigma_A D^T + Sigma_B + D C + C^T D^T`, `D = Ad(B^-1)`.
pub fn compose_correlated<G: LieGroup<DOF>, const DOF: usize>(
    first_covariance: &SMatrix<f64, DOF, DOF>,
    second: &G,
    second_covariance: &SMatrix<f64, DOF, DOF>,
    cross_covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    let adjoint = second.inverse().adjoint();
    let cross = adjoint * cross_covariance;
    symmetric(
        adjoint * first_covariance * adjoint.transpose() + second_covariance + cross + cross.transpose(),
    )
}

/// Covariance of `A^-1`: `Ad(A) Sigma_A Ad(A)^T`.
pub fn inverse<G: LieGroup<DOF>, const DOF: usize>(
    pose: &G,
    covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    to_reference(pose, covariance)
}

/// Covariance of `A^-1 B` for independent poses: `Ad(M^-1) Sigma_A Ad(M^-1)^T + Sigma_B`, `M = A^-1 B`.
pub fn between<G: LieGroup<DOF>, const DOF: usize>(
    first: &G,
    first_covariance: &SMatrix<f64, DOF, DOF>,
    second: &G,
    second_covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    between_correlated(first, first_covariance, second, second_covariance, &SMatrix::zeros())
}

/// Covariance of `M = A^-1 B` with the cross-covariance `C = E[a b^T]`:
/// `D Sigma_A D^T + Sigma_B - D C - C^T D^T`, `D = Ad(M^-1)`.
pub fn between_correlated<G: LieGroup<DOF>, const DOF: usize>(
    first: &G,
    first_covariance: &SMatrix<f64, DOF, DOF>,
    second: &G,
    second_covariance: &SMatrix<f64, DOF, DOF>,
    cross_covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    let relative = first.between(second);
    compose_correlated(first_covariance, &relative, second_covariance, &-cross_covariance)
}

/// The covariance of a pose in its reference frame (that of a *left* perturbation): `Ad(T) Sigma Ad(T)^T`.
pub fn to_reference<G: LieGroup<DOF>, const DOF: usize>(
    pose: &G,
    covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    let adjoint = pose.adjoint();
    symmetric(adjoint * covariance * adjoint.transpose())
}

/// Converts the covariance of a left perturbation to that of a right perturbation, in the pose's own frame:
/// `Ad(T^-1) Sigma Ad(T^-1)^T`. The inverse of [`to_reference`].
pub fn to_body<G: LieGroup<DOF>, const DOF: usize>(
    pose: &G,
    covariance: &SMatrix<f64, DOF, DOF>,
) -> SMatrix<f64, DOF, DOF> {
    to_reference(&pose.inverse(), covariance)
}

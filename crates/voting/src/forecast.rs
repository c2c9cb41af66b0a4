//! What an optimum says of an edge that is not part of it, before it is optimised again.

use nalgebra::{SMatrix, SVector};

/// The effect of one more landmark edge, to first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// By how much chi-square of the whole grows.
    pub increase: f64,
    /// Squared Mahalanobis residual that the edge keeps.
    pub residual: f64,
}

/// The innovation of an edge of residual `e` and covariance S, between poses whose relative pose has the covariance P and moves the
/// residual by J: chi-square grows by `e^T (S + J P J^T)^-1 e`, and the edge keeps the residual `S (S + J P J^T)^-1 e`. `None` where a
/// covariance has no inverse.
pub(crate) fn forecast<const DOF: usize>(
    error: &SVector<f64, DOF>,
    information: &SMatrix<f64, DOF, DOF>,
    jacobian: &SMatrix<f64, DOF, DOF>,
    relative: &SMatrix<f64, DOF, DOF>,
) -> Option<Forecast> {
    let own = information.cholesky()?.inverse();
    let innovation = own + jacobian * relative * jacobian.transpose();
    let force = innovation.cholesky()?.solve(error);
    Some(Forecast { increase: error.dot(&force), residual: force.dot(&(own * force)) })
}

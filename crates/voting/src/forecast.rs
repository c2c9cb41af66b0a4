//! Predicts the effect of one more edge on an optimum, without a new optimisation.

use nalgebra::{SMatrix, SVector};

/// The effect of one more landmark edge, to first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// The growth of the total chi-square.
    pub increase: f64,
    /// The squared Mahalanobis residual that the edge itself keeps.
    pub residual: f64,
}

/// Takes an edge of residual `e` and covariance S. The relative pose of its nodes has the covariance P and changes the
/// residual by J. Chi-square then grows by `e^T (S + J P J^T)^-1 e`, and the edge keeps the residual `S (S + J P J^T)^-1
/// e`. `None` if a covariance has no inverse.
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

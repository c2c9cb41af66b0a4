//! The innovation of a landmark edge: its measurement against the prediction of all other edges in use.

use nalgebra::SMatrix;
use posecut_geometry::LieGroup;
use posecut_pcm::chain::squared_mahalanobis;

/// The innovation of a landmark edge: how far its measurement is from what all *other* edges in use predict.
#[derive(Clone, Copy)]
pub(crate) struct Innovation<const DOF: usize> {
    /// Squared Mahalanobis distance, before scaling.
    pub(crate) squared: f64,
    pub(crate) covariance: SMatrix<f64, DOF, DOF>,
}

/// Let E = Z^-1 X, where X is the estimated relative pose with covariance P, and let r = Log(E) and H = J_r^-1(r). A
/// rejected edge has
///
/// d^2 = r^T (Sigma_Z + H P H^T)^-1 r.
///
/// P of an edge in use contains its own measurement. Without it, the sum becomes the difference Sigma_Z - H P H^T, the
/// covariance of a residual: both are the same quadratic form of the innovation. If that difference is not positive
/// definite, only the edge itself connects its two nodes, and there is no innovation: `None`.
pub(crate) fn innovation<G: LieGroup<DOF>, const DOF: usize>(
    measurement: &G,
    covariance: &SMatrix<f64, DOF, DOF>,
    estimate: &G,
    predicted: &SMatrix<f64, DOF, DOF>,
    in_use: bool,
) -> Option<Innovation<DOF>> {
    let residual = measurement.between(estimate).log();
    let jacobian = G::right_jacobian_inverse(&residual);
    let projected = jacobian * predicted * jacobian.transpose();
    // The remaining variance of an edge in use must exceed the rounding errors of both terms.
    let covariance = if in_use { covariance * (1.0 - 1e-6) - projected } else { covariance + projected };
    let squared = squared_mahalanobis(&covariance, &residual)?;
    Some(Innovation { squared, covariance })
}

//! Whether an information matrix can be one.

use posecut_geometry::covariance;

use crate::Dimension;

/// The smallest eigenvalue of an information matrix given by its upper triangle, if it is negative beyond the digits of a
/// printed file; see [`covariance::negative_eigenvalue`].
pub fn negative_eigenvalue(dimension: Dimension, upper_triangle: &[f64]) -> Option<f64> {
    crate::for_dimension!(dimension, |_G, DOF| covariance::negative_eigenvalue::<DOF>(upper_triangle))
}

//! Whether an information matrix can be one.

use posecut_geometry::covariance;

use crate::Dimension;

/// The smallest eigenvalue of an information matrix given by its upper triangle, if it is negative beyond the digits of a
/// printed file; see [`covariance::negative_eigenvalue`].
pub fn negative_eigenvalue(dimension: Dimension, upper_triangle: &[f64]) -> Option<f64> {
    match dimension {
        Dimension::Two => covariance::negative_eigenvalue::<3>(upper_triangle),
        Dimension::Three => covariance::negative_eigenvalue::<6>(upper_triangle),
    }
}

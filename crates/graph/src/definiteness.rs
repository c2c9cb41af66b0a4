//! Checks whether an information matrix is positive semidefinite.

use posecut_geometry::covariance;

use crate::Dimension;

/// The smallest eigenvalue of an information matrix given by its upper triangle, if it is more negative than rounding in a
/// printed file explains; see [`covariance::negative_eigenvalue`].
pub fn negative_eigenvalue(dimension: Dimension, upper_triangle: &[f64]) -> Option<f64> {
    crate::for_dimension!(dimension, |_G, DOF| covariance::negative_eigenvalue::<DOF>(upper_triangle))
}

/// The same for the information matrix of a position, which has 3 or 6 terms.
pub fn negative_eigenvalue_of_position(dimension: Dimension, upper_triangle: &[f64]) -> Option<f64> {
    match dimension {
        Dimension::Two => covariance::negative_eigenvalue::<2>(upper_triangle),
        Dimension::Three => covariance::negative_eigenvalue::<3>(upper_triangle),
    }
}

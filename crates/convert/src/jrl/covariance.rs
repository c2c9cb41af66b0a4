//! Covariances of JRL: whole matrices, row by row, in gtsam's order of the axes.

use nalgebra::SMatrix;
use posecut_geometry::covariance::{
    covariance_from_information, information_from_covariance, pack_upper_triangle, unpack_upper_triangle,
};
use posecut_graph::{Dimension, for_dimension};

/// A matrix may differ from its transpose by this share of its scale, because few digits were printed.
const ASYMMETRY: f64 = 1e-6;

/// The place of our axis in gtsam's order: a Pose3 has its rotation first.
fn place(freedom: usize, axis: usize) -> usize {
    if freedom == 6 { (axis + 3) % 6 } else { axis }
}

/// The packed information matrix of a covariance. The error is a sentence without place.
pub(super) fn information(dimension: Dimension, covariance: &[f64]) -> Result<Vec<f64>, String> {
    for_dimension!(dimension, |_G, DOF| {
        if covariance.len() != DOF * DOF {
            return Err(format!("the covariance has {} numbers instead of {}", covariance.len(), DOF * DOF));
        }
        let term = |row: usize, column: usize| covariance[place(DOF, row) * DOF + place(DOF, column)];
        let given = SMatrix::<f64, DOF, DOF>::from_fn(term);
        let scale = |row: usize, column: usize| {
            (given[(row, row)].abs().sqrt() * given[(column, column)].abs().sqrt())
                .max(given[(row, column)].abs())
        };
        // Average what differs by rounding; the inversion refuses what differs by more.
        let symmetric = SMatrix::<f64, DOF, DOF>::from_fn(|row, column| {
            let (term, mirrored) = (given[(row, column)], given[(column, row)]);
            let rounding = (term - mirrored).abs() <= ASYMMETRY * scale(row, column);
            if rounding { 0.5 * term + 0.5 * mirrored } else { term }
        });
        let inverse = information_from_covariance::<DOF>(&symmetric).map_err(|error| error.to_string())?;
        // Adding zero makes -0 a 0.
        let packed = pack_upper_triangle(&inverse.map(|term| term + 0.0));
        match packed.iter().find(|term| !term.is_finite()) {
            None => Ok(packed),
            Some(term) => Err(format!("the inverse of the covariance has the term {term}")),
        }
    })
}

/// The covariance of a packed information matrix, row by row. The error is a sentence without place.
pub(super) fn covariance(dimension: Dimension, information: &[f64]) -> Result<Vec<f64>, String> {
    for_dimension!(dimension, |_G, DOF| {
        let matrix = unpack_upper_triangle::<DOF>(information).map_err(|error| error.to_string())?;
        let inverse = covariance_from_information::<DOF>(&matrix).map_err(|error| error.to_string())?;
        let mut terms = vec![0.0; DOF * DOF];
        for row in 0..DOF {
            for column in 0..DOF {
                terms[place(DOF, row) * DOF + place(DOF, column)] = inverse[(row, column)] + 0.0;
            }
        }
        match terms.iter().find(|term| !term.is_finite()) {
            None => Ok(terms),
            Some(term) => Err(format!("its inverse has the term {term}")),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rotation_is_first() {
        // Variances of rotations 1, 2, 4 and of translations 8, 16, 32; rx and y are correlated.
        let mut rows = vec![0.0; 36];
        for (axis, variance) in [1.0, 2.0, 4.0, 8.0, 16.0, 32.0].into_iter().enumerate() {
            rows[7 * axis] = variance;
        }
        (rows[4], rows[24]) = (2.0, 2.0);
        let packed = information(Dimension::Three, &rows).unwrap();
        let close = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{packed:?}");
        close(packed[0], 1.0 / 8.0);
        close(packed[11], 1.0 / 32.0);
        close(packed[20], 1.0 / 4.0);
        // The inverse of [[16, 2], [2, 1]] (y and rx) is [[1, -2], [-2, 16]] / 12.
        close(packed[6], 1.0 / 12.0);
        close(packed[8], -2.0 / 12.0);
        close(packed[15], 16.0 / 12.0);
        let again = covariance(Dimension::Three, &packed).unwrap();
        assert!(rows.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1e-12), "{again:?}");
    }

    #[test]
    fn rounding_is_averaged_and_asymmetry_refused() {
        let rows = |mirrored: f64| vec![1.0, 0.5, 0.0, mirrored, 1.0, 0.0, 0.0, 0.0, 1.0];
        assert!(information(Dimension::Two, &rows(0.500_000_1)).is_ok());
        assert!(information(Dimension::Two, &rows(0.6)).unwrap_err().contains("not symmetric"));
        assert!(information(Dimension::Two, &rows(f64::MAX)).is_err());
        assert!(information(Dimension::Two, &[1.0]).unwrap_err().contains("1 numbers instead of 9"));
        assert!(information(Dimension::Two, &[0.0; 9]).unwrap_err().contains("singular"));
    }
}

//! The upper triangle of a symmetric matrix as a flat list, row after row.

use nalgebra::SMatrix;
use thiserror::Error;

/// A flat list that is not an upper triangle.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PackingError {
    /// The length of the list does not match the matrix.
    #[error(
        "{found} terms cannot fill the upper triangle of a {size} x {size} matrix: write its {expected} terms row by row"
    )]
    Length {
        /// Number of terms given.
        found: usize,
        /// Number of terms needed.
        expected: usize,
        /// Rows of the matrix.
        size: usize,
    },
}

/// Number of terms of the upper triangle of a `size` x `size` matrix: 6 in the plane, 21 in space.
pub const fn packed_length(size: usize) -> usize {
    size * (size + 1) / 2
}

/// The upper triangle, row-major: `m11, m12, ..., m22, ...`.
pub fn pack_upper_triangle<const DOF: usize>(matrix: &SMatrix<f64, DOF, DOF>) -> Vec<f64> {
    (0..DOF).flat_map(|row| (row..DOF).map(move |column| matrix[(row, column)])).collect()
}

/// The symmetric matrix with this upper triangle, row-major.
pub fn unpack_upper_triangle<const DOF: usize>(
    terms: &[f64],
) -> Result<SMatrix<f64, DOF, DOF>, PackingError> {
    let expected = packed_length(DOF);
    if terms.len() != expected {
        return Err(PackingError::Length { found: terms.len(), expected, size: DOF });
    }
    let mut matrix = SMatrix::zeros();
    let positions = (0..DOF).flat_map(|row| (row..DOF).map(move |column| (row, column)));
    for ((row, column), &term) in positions.zip(terms) {
        matrix[(row, column)] = term;
        matrix[(column, row)] = term;
    }
    Ok(matrix)
}

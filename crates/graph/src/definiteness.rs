//! Whether an information matrix can be one.

use nalgebra::DMatrix;

use crate::Dimension;

/// An eigenvalue this far below zero, relative to the largest, is taken for rounding in print.
pub(crate) const PRINT_TOLERANCE: f64 = 1e-9;

/// The smallest eigenvalue if the matrix of that upper triangle is not positive semidefinite, else `None`.
/// A factorisation settles the usual case in O(side^3); eigenvalues are computed for the rest alone.
pub(crate) fn negative_eigenvalue(dimension: Dimension, upper_triangle: &[f64]) -> Option<f64> {
    let side = dimension.degrees_of_freedom();
    if has_cholesky_factor(side, upper_triangle) {
        return None;
    }
    let mut matrix = DMatrix::zeros(side, side);
    let mut terms = upper_triangle.iter();
    for row in 0..side {
        for column in row..side {
            let term = terms.next().copied().unwrap_or(0.0);
            matrix[(row, column)] = term;
            matrix[(column, row)] = term;
        }
    }
    let eigenvalues = matrix.symmetric_eigenvalues();
    let smallest = eigenvalues.min();
    let largest = eigenvalues.amax();
    (smallest < -PRINT_TOLERANCE * largest).then_some(smallest)
}

fn has_cholesky_factor(side: usize, upper_triangle: &[f64]) -> bool {
    let mut factor = [[0.0_f64; 6]; 6];
    let mut next = 0;
    for row in 0..side {
        for column in row..side {
            let mut value = upper_triangle[next];
            next += 1;
            for above in factor.iter().take(row) {
                value -= above[row] * above[column];
            }
            if column == row {
                if value <= 0.0 {
                    return false;
                }
                factor[row][row] = value.sqrt();
            } else {
                factor[row][column] = value / factor[row][row];
            }
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definite_matrices_pass() {
        assert_eq!(negative_eigenvalue(Dimension::Two, &[2.0, 0.5, 0.1, 3.0, 0.2, 1.0]), None);
    }

    #[test]
    fn matrices_semidefinite_in_print_pass() {
        assert_eq!(negative_eigenvalue(Dimension::Two, &[1.0, 1.0, 0.0, 1.0, 0.0, 1.0]), None);
        assert_eq!(negative_eigenvalue(Dimension::Two, &[0.0; 6]), None);
        assert_eq!(negative_eigenvalue(Dimension::Two, &[1.0, 1.0, 0.0, 1.0 - 1e-10, 0.0, 1.0]), None);
    }

    #[test]
    fn indefinite_matrices_are_named_by_their_smallest_eigenvalue() {
        let smallest = negative_eigenvalue(Dimension::Two, &[1.0, 2.0, 0.0, 1.0, 0.0, 1.0]).unwrap();
        assert!((smallest + 1.0).abs() < 1e-12, "eigenvalues of [[1,2],[2,1]] are 3 and -1, got {smallest}");
    }
}

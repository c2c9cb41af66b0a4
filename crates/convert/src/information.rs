//! Information matrices that are none.

use nalgebra::DMatrix;

/// What is done about a matrix that is not positive semidefinite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repair {
    /// Refuse it with its line.
    Refuse,
    /// Set negative eigenvalues to zero: the nearest positive semidefinite matrix.
    Clamp,
}

/// An eigenvalue this far below zero, relative to the largest, is rounding in print.
const PRINT_TOLERANCE: f64 = 1e-9;

/// The smallest eigenvalue of an upper triangle, if it is negative beyond rounding.
pub(crate) fn negative_eigenvalue(side: usize, packed: &[f64]) -> Option<f64> {
    let eigenvalues = unpack(side, packed).symmetric_eigenvalues();
    let (smallest, largest) = (eigenvalues.min(), eigenvalues.amax());
    (smallest < -PRINT_TOLERANCE * largest).then_some(smallest)
}

/// The nearest positive semidefinite matrix in the Frobenius norm (Higham 1988): the same eigenvectors, no
/// negative eigenvalue.
pub(crate) fn clamp(side: usize, packed: &[f64]) -> Vec<f64> {
    let eigen = unpack(side, packed).symmetric_eigen();
    let eigenvalues = eigen.eigenvalues.map(|value| value.max(0.0));
    let matrix = &eigen.eigenvectors * DMatrix::from_diagonal(&eigenvalues) * eigen.eigenvectors.transpose();
    (0..side)
        .flat_map(|row| (row..side).map(move |column| (row, column)))
        .map(|place| matrix[place])
        .collect()
}

/// The symmetric matrix with this upper triangle.
pub(crate) fn unpack(side: usize, packed: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(side, side);
    let mut terms = packed.iter();
    for row in 0..side {
        for column in row..side {
            let term = terms.next().copied().unwrap_or(0.0);
            matrix[(row, column)] = term;
            matrix[(column, row)] = term;
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clamping_keeps_definite_matrices_and_mends_others() {
        let definite = [2.0, 0.5, 0.1, 3.0, 0.2, 1.0];
        let kept = clamp(3, &definite);
        assert!(definite.iter().zip(&kept).all(|(a, b)| (a - b).abs() < 1e-12), "{kept:?}");
        let indefinite = [1.0, 2.0, 0.0, 1.0, 0.0, 1.0];
        assert!((negative_eigenvalue(3, &indefinite).unwrap() + 1.0).abs() < 1e-12);
        let mended = clamp(3, &indefinite);
        assert_eq!(negative_eigenvalue(3, &mended), None);
        // Eigenvalues 3 and -1 of [[1,2],[2,1]]: the 3 stays, along (1,1)/sqrt 2.
        assert!((mended[0] - 1.5).abs() < 1e-12 && (mended[1] - 1.5).abs() < 1e-12, "{mended:?}");
    }
}

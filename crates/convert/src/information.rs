//! Handles information matrices that are not positive semidefinite.

use nalgebra::DMatrix;
use posecut_graph::Dimension;

/// How to treat such a matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Repair {
    /// Refuse it, with an error that names its line.
    Refuse,
    /// Replace it by the nearest positive semidefinite matrix: set negative eigenvalues to zero.
    Clamp,
}

/// The nearest positive semidefinite matrix in the Frobenius norm (Higham 1988): the same eigenvectors, with negative
/// eigenvalues set to zero. `None` if a term exceeds the range of doubles.
pub(crate) fn clamp(dimension: Dimension, packed: &[f64]) -> Option<Vec<f64>> {
    let side = dimension.degrees_of_freedom();
    let matrix = unpack(side, packed);
    // Scale entries to at most 1: squares of entries near 1e300 would overflow in the eigenvalue iteration.
    let scale = matrix.amax();
    if !scale.is_finite() {
        return None;
    }
    let eigen = (matrix / scale).symmetric_eigen();
    let eigenvalues = eigen.eigenvalues.map(|value| value.max(0.0));
    let clamped = &eigen.eigenvectors * DMatrix::from_diagonal(&eigenvalues) * eigen.eigenvectors.transpose();
    let terms: Vec<f64> = (0..side)
        .flat_map(|row| (row..side).map(move |column| (row, column)))
        .map(|place| clamped[place] * scale)
        .collect();
    terms.iter().all(|term| term.is_finite()).then_some(terms)
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
    use posecut_graph::negative_eigenvalue;

    use super::*;

    #[test]
    fn clamping_keeps_definite_matrices_and_mends_others() {
        let definite = [2.0, 0.5, 0.1, 3.0, 0.2, 1.0];
        let kept = clamp(Dimension::Two, &definite).unwrap();
        assert!(definite.iter().zip(&kept).all(|(a, b)| (a - b).abs() < 1e-12), "{kept:?}");
        let indefinite = [1.0, 2.0, 0.0, 1.0, 0.0, 1.0];
        assert!((negative_eigenvalue(Dimension::Two, &indefinite).unwrap() + 1.0).abs() < 1e-12);
        let mended = clamp(Dimension::Two, &indefinite).unwrap();
        assert_eq!(negative_eigenvalue(Dimension::Two, &mended), None);
        // Eigenvalues 3 and -1 of [[1,2],[2,1]]: the 3 stays, along (1,1)/sqrt 2.
        assert!((mended[0] - 1.5).abs() < 1e-12 && (mended[1] - 1.5).abs() < 1e-12, "{mended:?}");
    }
}

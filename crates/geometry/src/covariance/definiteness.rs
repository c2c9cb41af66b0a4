//! Whether a symmetric matrix can be an information matrix.

use nalgebra::{DMatrix, SMatrix};

/// A smallest eigenvalue above minus this share of the largest is zero in print: files carry six to nine digits.
const PRINT_TOLERANCE: f64 = 1e-9;

/// What the eigenvalues of a symmetric matrix say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Definiteness {
    /// All eigenvalues are positive beyond rounding.
    PositiveDefinite,
    /// The smallest eigenvalue is zero up to the digits of a printed file: at least -1e-9 times the largest.
    Semidefinite {
        /// Smallest eigenvalue.
        smallest: f64,
        /// Largest eigenvalue.
        largest: f64,
    },
    /// An eigenvalue is negative: no covariance has this inverse.
    Indefinite {
        /// Smallest eigenvalue.
        smallest: f64,
        /// Largest eigenvalue.
        largest: f64,
    },
    /// An entry is NaN or infinite.
    NotFinite,
}

/// Classifies the symmetric part of a matrix by its eigenvalues. Takes O(DOF^3).
pub fn definiteness<const DOF: usize>(matrix: &SMatrix<f64, DOF, DOF>) -> Definiteness {
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return Definiteness::NotFinite;
    }
    // Scaled to entries of at most 1: squares of entries near 1e300 would overflow in the eigenvalue iteration.
    let scale = matrix.amax();
    if scale == 0.0 {
        return Definiteness::Semidefinite { smallest: 0.0, largest: 0.0 };
    }
    let symmetric = DMatrix::from_fn(DOF, DOF, |row, column| {
        0.5 * (matrix[(row, column)] / scale + matrix[(column, row)] / scale)
    });
    let eigenvalues = symmetric.symmetric_eigenvalues();
    let (smallest, largest) = (eigenvalues.min(), eigenvalues.max());
    let rounding = f64::EPSILON * DOF as f64 * largest;
    let (printed_smallest, printed_largest) = (smallest * scale, largest * scale);
    if smallest > rounding {
        Definiteness::PositiveDefinite
    } else if smallest >= -PRINT_TOLERANCE * largest {
        Definiteness::Semidefinite { smallest: printed_smallest, largest: printed_largest }
    } else {
        Definiteness::Indefinite { smallest: printed_smallest, largest: printed_largest }
    }
}

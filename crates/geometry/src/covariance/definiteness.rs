//! Whether a symmetric matrix can be an information matrix.

use nalgebra::{DMatrix, SMatrix};

use super::packing::{packed_length, unpack_upper_triangle};

/// A smallest eigenvalue within this share of the largest counts as zero, since files have six to nine digits.
const PRINT_TOLERANCE: f64 = 1e-9;

/// Definiteness of a symmetric matrix by its eigenvalues.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Definiteness {
    /// All eigenvalues are positive beyond the digits of a printed file: above 1e-9 times the largest.
    PositiveDefinite,
    /// The smallest eigenvalue is zero up to the digits of a printed file: within 1e-9 times the largest, of either sign.
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
    // Scaled to entries of at most 1: otherwise squares of entries near 1e300 overflow in the eigenvalue iteration.
    let scale = matrix.amax();
    if scale == 0.0 {
        return Definiteness::Semidefinite { smallest: 0.0, largest: 0.0 };
    }
    let symmetric = DMatrix::from_fn(DOF, DOF, |row, column| {
        0.5 * (matrix[(row, column)] / scale + matrix[(column, row)] / scale)
    });
    let eigenvalues = symmetric.symmetric_eigenvalues();
    let (smallest, largest) = (eigenvalues.min(), eigenvalues.max());
    let (printed_smallest, printed_largest) = (smallest * scale, largest * scale);
    if smallest > PRINT_TOLERANCE * largest {
        Definiteness::PositiveDefinite
    } else if smallest >= -PRINT_TOLERANCE * largest {
        Definiteness::Semidefinite { smallest: printed_smallest, largest: printed_largest }
    } else {
        Definiteness::Indefinite { smallest: printed_smallest, largest: printed_largest }
    }
}

/// The smallest eigenvalue of an information matrix given by its upper triangle, if it is negative beyond the digits of a
/// printed file ([`Definiteness::Indefinite`]); NaN if a term is not finite or there are too few.
///
/// A factorisation decides the usual case, a positive definite matrix. Eigenvalues are computed only if it fails. Takes
/// O(DOF^3).
pub fn negative_eigenvalue<const DOF: usize>(upper_triangle: &[f64]) -> Option<f64> {
    if has_cholesky_factor::<DOF>(upper_triangle) {
        return None;
    }
    let Ok(matrix) = unpack_upper_triangle::<DOF>(upper_triangle) else { return Some(f64::NAN) };
    match definiteness(&matrix) {
        Definiteness::PositiveDefinite | Definiteness::Semidefinite { .. } => None,
        Definiteness::Indefinite { smallest, .. } => Some(smallest),
        Definiteness::NotFinite => Some(f64::NAN),
    }
}

/// Whether all pivots are positive and finite. If products of entries overflow, this is false, and the scaled eigenvalues
/// decide.
fn has_cholesky_factor<const DOF: usize>(upper_triangle: &[f64]) -> bool {
    if upper_triangle.len() != packed_length(DOF) {
        return false;
    }
    let mut factor = [[0.0_f64; DOF]; DOF];
    let mut next = 0;
    for row in 0..DOF {
        for column in row..DOF {
            let mut value = upper_triangle[next];
            next += 1;
            for above in factor.iter().take(row) {
                value -= above[row] * above[column];
            }
            if column == row {
                if !(value > 0.0 && value.is_finite()) {
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
    fn definite_and_printed_semidefinite_matrices_pass() {
        assert_eq!(negative_eigenvalue::<3>(&[2.0, 0.5, 0.1, 3.0, 0.2, 1.0]), None);
        assert_eq!(negative_eigenvalue::<3>(&[1.0, 1.0, 0.0, 1.0, 0.0, 1.0]), None);
        assert_eq!(negative_eigenvalue::<3>(&[0.0; 6]), None);
        assert_eq!(negative_eigenvalue::<3>(&[1.0, 1.0, 0.0, 1.0 - 1e-10, 0.0, 1.0]), None);
        assert_eq!(negative_eigenvalue::<3>(&[1e308, 0.0, 0.0, 1e308, 0.0, 1e308]), None);
    }

    #[test]
    fn indefinite_matrices_are_named_by_their_smallest_eigenvalue() {
        let smallest = negative_eigenvalue::<3>(&[1.0, 2.0, 0.0, 1.0, 0.0, 1.0]).unwrap();
        assert!((smallest + 1.0).abs() < 1e-12, "eigenvalues of [[1,2],[2,1]] are 3 and -1, got {smallest}");
        assert!(negative_eigenvalue::<3>(&[f64::NAN; 6]).unwrap().is_nan());
        assert!(negative_eigenvalue::<3>(&[1.0; 5]).unwrap().is_nan());
    }

    /// The products of such entries overflow to NaN, which is not below zero: the factorisation must not accept it.
    #[test]
    fn indefinite_matrices_of_huge_entries_are_indefinite() {
        let huge = 1e200;
        let smallest =
            negative_eigenvalue::<3>(&[huge, 2.0 * huge, 1e-200, huge, -2.0 * huge, huge]).unwrap();
        assert!(smallest < -0.9 * huge, "{smallest:e}");
        let mut terms = [0.0; 21];
        for place in [0, 6, 11, 15, 18, 20] {
            terms[place] = 1e-300;
        }
        (terms[1], terms[2], terms[7]) = (1e300, 1e300, 1e300);
        assert!(negative_eigenvalue::<6>(&terms).unwrap() < 0.0);
    }
}

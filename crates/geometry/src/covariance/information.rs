//! Information matrices and covariances, each the inverse of the other.

use nalgebra::SMatrix;
use thiserror::Error;

/// Why a matrix cannot be inverted as a covariance or an information matrix.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum CovarianceError {
    /// An entry is NaN or infinite.
    #[error("the matrix holds {value} at row {row}, column {column}: give finite numbers")]
    NotFinite {
        /// Row of the entry, from 0.
        row: usize,
        /// Column of the entry, from 0.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The matrix differs from its transpose by more than rounding.
    #[error(
        "the matrix is not symmetric: row {row}, column {column} and its mirror image differ by {difference:e}; \
         average the two or correct the one that is wrong"
    )]
    NotSymmetric {
        /// Row of the entry above the diagonal, from 0.
        row: usize,
        /// Column of that entry, from 0.
        column: usize,
        /// Entry minus mirror image.
        difference: f64,
    },
    /// A direction has zero variance or information, up to rounding.
    #[error(
        "the matrix is singular to working precision: component {index} is determined by the ones before it; \
         give every direction a positive variance"
    )]
    Singular {
        /// Component at which elimination left nothing, from 0.
        index: usize,
    },
    /// A direction has negative variance or information.
    #[error(
        "the matrix is not positive definite: eliminating the components before {index} leaves {pivot:e} there; \
         check the order and the signs of its terms"
    )]
    NotPositiveDefinite {
        /// Component at which elimination failed, from 0.
        index: usize,
        /// The remaining diagonal entry, as a share of the original entry.
        pivot: f64,
    },
}

/// The information matrix of a covariance, `Sigma^-1`. Errors as for [`covariance_from_information`].
pub fn information_from_covariance<const DOF: usize>(
    covariance: &SMatrix<f64, DOF, DOF>,
) -> Result<SMatrix<f64, DOF, DOF>, CovarianceError> {
    inverse_positive_definite(covariance)
}

/// The covariance of an information matrix, `Omega^-1`.
///
/// The error depends on the condition number of the matrix *scaled to unit diagonal*, so units do not matter (micrometres
/// with radians). The result is symmetric to the bit. Singular, indefinite, unsymmetric and non-finite matrices are errors.
pub fn covariance_from_information<const DOF: usize>(
    information: &SMatrix<f64, DOF, DOF>,
) -> Result<SMatrix<f64, DOF, DOF>, CovarianceError> {
    inverse_positive_definite(information)
}

/// Inverse by Cholesky of `D^-1 A D^-1` with `D = sqrt(diag A)`.
fn inverse_positive_definite<const DOF: usize>(
    matrix: &SMatrix<f64, DOF, DOF>,
) -> Result<SMatrix<f64, DOF, DOF>, CovarianceError> {
    check_symmetric(matrix)?;
    let mut scale = [0.0; DOF];
    for (index, scale) in scale.iter_mut().enumerate() {
        let diagonal = matrix[(index, index)];
        if diagonal < 0.0 {
            return Err(CovarianceError::NotPositiveDefinite { index, pivot: -1.0 });
        }
        if diagonal == 0.0 {
            return Err(CovarianceError::Singular { index });
        }
        *scale = 1.0 / diagonal.sqrt();
    }
    let scaled =
        SMatrix::<f64, DOF, DOF>::from_fn(|row, column| matrix[(row, column)] * scale[row] * scale[column]);
    let inverse_factor = invert_lower(&cholesky(&scaled)?);
    Ok(SMatrix::from_fn(|row, column| {
        // Rows above max(row, column) of the inverse factor are zero. Both sides of the diagonal get the same sum.
        let sum: f64 =
            (row.max(column)..DOF).map(|k| inverse_factor[(k, row)] * inverse_factor[(k, column)]).sum();
        sum * (scale[row] * scale[column])
    }))
}

/// Refuses NaN, infinity, and asymmetry beyond 1e-9 of the entry's scale.
fn check_symmetric<const DOF: usize>(matrix: &SMatrix<f64, DOF, DOF>) -> Result<(), CovarianceError> {
    for row in 0..DOF {
        for column in 0..DOF {
            let value = matrix[(row, column)];
            if !value.is_finite() {
                return Err(CovarianceError::NotFinite { row, column, value });
            }
        }
    }
    for row in 0..DOF {
        for column in row + 1..DOF {
            let difference = matrix[(row, column)] - matrix[(column, row)];
            let magnitude = (matrix[(row, row)].abs().sqrt() * matrix[(column, column)].abs().sqrt())
                .max(matrix[(row, column)].abs());
            if difference.abs() > 1e-9 * magnitude {
                return Err(CovarianceError::NotSymmetric { row, column, difference });
            }
        }
    }
    Ok(())
}

/// Lower Cholesky factor of a matrix with unit diagonal. The loops are written out, since nalgebra's function needs bounds
/// that a generic `DOF` lacks.
fn cholesky<const DOF: usize>(
    matrix: &SMatrix<f64, DOF, DOF>,
) -> Result<SMatrix<f64, DOF, DOF>, CovarianceError> {
    let rounding = 4.0 * DOF as f64 * f64::EPSILON;
    let mut factor = SMatrix::<f64, DOF, DOF>::zeros();
    for index in 0..DOF {
        for column in 0..=index {
            let products: f64 = (0..column).map(|k| factor[(index, k)] * factor[(column, k)]).sum();
            let rest = matrix[(index, column)] - products;
            if column < index {
                factor[(index, column)] = rest / factor[(column, column)];
            } else if rest > rounding {
                factor[(index, index)] = rest.sqrt();
            } else if rest >= -rounding {
                return Err(CovarianceError::Singular { index });
            } else {
                return Err(CovarianceError::NotPositiveDefinite { index, pivot: rest });
            }
        }
    }
    Ok(factor)
}

/// Inverse of a lower triangular matrix without zeros on its diagonal.
fn invert_lower<const DOF: usize>(factor: &SMatrix<f64, DOF, DOF>) -> SMatrix<f64, DOF, DOF> {
    let mut inverse = SMatrix::<f64, DOF, DOF>::zeros();
    for column in 0..DOF {
        inverse[(column, column)] = 1.0 / factor[(column, column)];
        for row in column + 1..DOF {
            let products: f64 = (column..row).map(|k| factor[(row, k)] * inverse[(k, column)]).sum();
            inverse[(row, column)] = -products / factor[(row, row)];
        }
    }
    inverse
}

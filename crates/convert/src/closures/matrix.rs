//! Covariances and information matrices in the columns of a table.

use nalgebra::{DMatrix, SMatrix};
use posecut_geometry::covariance::information_from_covariance;
use posecut_graph::{Dimension, for_dimension, negative_eigenvalue};

use super::Row;
use crate::ConvertError;

/// What the names of a covariance's columns begin with.
pub(super) const COVARIANCE: &str = "cov_";

/// What the names of an information matrix's columns begin with.
pub(super) const INFORMATION: &str = "info_";

/// A term of a matrix and the column of the table that holds it.
pub(super) struct Term {
    pub(super) row: usize,
    pub(super) column: usize,
    pub(super) field: usize,
}

/// The names of the axes, in the order of the matrix.
pub(super) fn axes(dimension: Dimension) -> &'static [&'static str] {
    match dimension {
        Dimension::Two => &["x", "y", "theta"],
        Dimension::Three => &["x", "y", "z", "rx", "ry", "rz"],
    }
}

/// The places of the upper triangle, row by row.
pub(super) fn terms(dimension: Dimension) -> Vec<(usize, usize)> {
    let side = axes(dimension).len();
    (0..side).flat_map(|row| (row..side).map(move |column| (row, column))).collect()
}

/// The packed information matrix of a row.
pub(super) fn information(
    row: &Row,
    inverse: bool,
    given: &[Term],
    dimension: Dimension,
) -> Result<Vec<f64>, ConvertError> {
    let side = axes(dimension).len();
    let mut matrix = DMatrix::zeros(side, side);
    for term in given {
        let value = row.number(row.field(term.field))?;
        matrix[(term.row, term.column)] = value;
        matrix[(term.column, term.row)] = value;
    }
    if inverse {
        matrix = inverted(row, &matrix, dimension)?;
    }
    // Adding zero makes -0 a 0.
    let packed: Vec<f64> = terms(dimension).into_iter().map(|place| matrix[place] + 0.0).collect();
    if let Some(eigenvalue) = negative_eigenvalue(dimension, &packed) {
        return Err(row.refuse(
            format!("the information matrix is not positive semidefinite: its smallest eigenvalue is {eigenvalue:e}"),
            "correct it at its source",
        ));
    }
    if let Some(term) = packed.iter().find(|term| !term.is_finite()) {
        return Err(row.refuse(
            format!("the information matrix has the term {term}"),
            "give covariances that a double can invert",
        ));
    }
    Ok(packed)
}

/// The inverse of a covariance.
pub(crate) fn inverted(
    row: &Row,
    covariance: &DMatrix<f64>,
    dimension: Dimension,
) -> Result<DMatrix<f64>, ConvertError> {
    for_dimension!(dimension, |_G, DOF| {
        let fixed = SMatrix::<f64, DOF, DOF>::from_fn(|row, column| covariance[(row, column)]);
        information_from_covariance::<DOF>(&fixed)
            .map(|information| DMatrix::from_fn(DOF, DOF, |row, column| information[(row, column)]))
            .map_err(|error| row.refuse("the covariance has no inverse", error.to_string()))
    })
}

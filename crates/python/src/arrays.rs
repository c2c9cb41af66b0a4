//! Arrays of a graph. Each is one vector of Rust that numpy takes over without another copy, and that cannot be written to.

use numpy::{Element, IntoPyArray as _, PyArray1, PyArrayMethods as _};
use posecut_graph::{Dimension, EdgeKind, PoseGraph};
use pyo3::prelude::*;

use crate::error::Error;

/// A table of numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Table {
    /// (nodes, 3 or 7): the estimates.
    Poses,
    /// (nodes, 3 or 7): the ground truth.
    Truth,
    /// (edges, 3 or 7).
    Measurements,
    /// (edges, 3, 3) or (edges, 6, 6).
    Information,
}

impl Table {
    /// The table of that name.
    pub(crate) fn named(name: &str) -> PyResult<Self> {
        match name {
            "poses" => Ok(Self::Poses),
            "truth" => Ok(Self::Truth),
            "measurements" => Ok(Self::Measurements),
            "information" => Ok(Self::Information),
            _ => Err(Error::new_err(format!("there is no table {name:?}"))),
        }
    }

    /// The numbers, and the shape of the array. What a record does not have is NaN.
    pub(crate) fn of(self, graph: &PoseGraph) -> (Vec<f64>, Vec<usize>) {
        let dimension = graph.header.dimension;
        let (side, width) = (dimension.degrees_of_freedom(), dimension.pose_components());
        match self {
            Self::Poses => rows(width, graph.nodes.iter().map(|node| node.pose.as_deref())),
            Self::Truth => rows(width, graph.nodes.iter().map(|node| node.truth.as_ref()?.pose.as_deref())),
            Self::Measurements => rows(width, graph.edges.iter().map(|edge| edge.measurement.as_deref())),
            Self::Information => {
                let mut values = Vec::with_capacity(graph.edges.len() * side * side);
                for edge in &graph.edges {
                    push_matrix(&mut values, graph.information(edge), dimension);
                }
                (values, vec![graph.edges.len(), side, side])
            }
        }
    }
}

/// Rows of equal width, one below the other.
fn rows<'a>(
    width: usize,
    records: impl ExactSizeIterator<Item = Option<&'a [f64]>>,
) -> (Vec<f64>, Vec<usize>) {
    let count = records.len();
    let mut values = Vec::with_capacity(count * width);
    for record in records {
        match record {
            Some(row) => values.extend_from_slice(row),
            None => values.extend(std::iter::repeat_n(f64::NAN, width)),
        }
    }
    (values, vec![count, width])
}

/// Appends the whole matrix of an upper triangle.
fn push_matrix(values: &mut Vec<f64>, upper: Option<&[f64]>, dimension: Dimension) {
    let side = dimension.degrees_of_freedom();
    let start = values.len();
    values.extend(std::iter::repeat_n(f64::NAN, side * side));
    let mut terms = upper.unwrap_or_default().iter();
    for row in 0..side {
        for column in row..side {
            let Some(&term) = terms.next() else { return };
            values[start + row * side + column] = term;
            values[start + column * side + row] = term;
        }
    }
}

/// An array of numbers that cannot be written to.
pub(crate) fn numbers(py: Python<'_>, values: Vec<f64>, shape: Vec<usize>) -> PyResult<Bound<'_, PyAny>> {
    let array = values.into_pyarray(py).reshape(shape)?;
    Ok(array.readwrite().make_nonwriteable().as_any().clone())
}

/// A row of values that cannot be written to.
pub(crate) fn row<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyAny> {
    let array: Bound<'_, PyArray1<T>> = values.into_pyarray(py);
    array.readwrite().make_nonwriteable().as_any().clone()
}

/// For each edge the rows of its nodes.
pub(crate) fn ends<'py>(py: Python<'py>, graph: &PoseGraph) -> PyResult<Bound<'py, PyAny>> {
    let row = |id| graph.node_index(id).map_or(-1, |index| index as i64);
    let values: Vec<i64> = graph.edges.iter().flat_map(|edge| [row(edge.from), row(edge.to)]).collect();
    let array = values.into_pyarray(py).reshape([graph.edges.len(), 2])?;
    Ok(array.readwrite().make_nonwriteable().as_any().clone())
}

/// A flag for each edge or node.
pub(crate) fn flags<'py>(py: Python<'py>, graph: &PoseGraph, which: &str) -> PyResult<Bound<'py, PyAny>> {
    let values: Vec<bool> = match which {
        "landmark" => graph.edges.iter().map(|edge| edge.kind == EdgeKind::Landmark).collect(),
        "rejected" => graph.edges.iter().map(|edge| !edge.in_use()).collect(),
        "fixed" => graph.nodes.iter().map(|node| node.is_fixed().unwrap_or(false)).collect(),
        _ => return Err(Error::new_err(format!("there is no flag {which:?}"))),
    };
    Ok(row(py, values))
}

//! The error of a factorisation that stops early.

use thiserror::Error;

/// The matrix is not positive definite.
#[derive(Clone, Debug, Error, PartialEq)]
#[error(
    "the matrix is not positive definite: the pivot of component {component} of variable {variable} is not positive"
)]
pub struct Breakdown {
    /// Variable whose pivot failed.
    pub variable: usize,
    /// Component of that variable, from 0.
    pub component: usize,
}

//! Covariances at a solution: blocks of the inverse of the Gauss-Newton matrix.
//!
//! `marginals` computes covariances of poses and of pairs of poses, component by component (`part`), from the blocks of
//! [`SelectedInverse`](posecut_cholesky::SelectedInverse) and
//! [`Factor::inverse_column`](posecut_cholesky::Factor::inverse_column) (`columns`).
//!
//! `at_solution` optimises and computes them with one analysis of the pattern.
//!
//! Depends on the model, on `normal_equations` and on `batch`.

pub(crate) mod at_solution;
mod columns;
pub(crate) mod marginals;
mod part;

//! Covariances at a solution: blocks of the inverse of the Gauss-Newton matrix.
//!
//! `marginals` computes covariances of poses and of pairs of poses from the blocks of
//! [`SelectedInverse`](posecut_cholesky::SelectedInverse) and
//! [`Factor::inverse_column`](posecut_cholesky::Factor::inverse_column).
//!
//! Depends on the model and on `normal_equations`.

pub(crate) mod marginals;

//! Covariances at a solution: blocks of the inverse of the Gauss-Newton matrix.
//!
//! `SelectedInverse` has all blocks where the factor has one, by the recursion of Takahashi, Fagan and Chen, 1973, front
//! by front: `Z_RJ = -Z_RR W` and `Z_JJ = L^-T L^-1 - W^T Z_RJ`, where `W = M L^-1`. `inverse_column` solves for the others
//! along the elimination tree. `marginals` makes covariances of poses and of pairs of poses from them.
//!
//! Depends on the model and on [`linear`](crate::linear).

mod inverse_column;
pub(crate) mod marginals;
mod selected_inverse;

pub use inverse_column::Workspace;
pub use selected_inverse::SelectedInverse;

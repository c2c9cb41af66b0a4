//! Sparse Cholesky factorisation of symmetric matrices made of small square blocks, one block row per pose.
//!
//! Ordering, elimination tree and structure of the factor are worked out on *blocks*, 9 to 36 times fewer than scalars;
//! the numeric phase is multifrontal (Duff and Reid, "The multifrontal solution of indefinite sparse symmetric linear
//! equations", 1983), so that all arithmetic is dense. [`Symbolic`] is made once per graph and serves every block size;
//! [`Factor`] owns all memory of the numeric phase and allocates none while it works.

pub(crate) mod dense;
mod elimination;
pub(crate) mod extend_add;
mod factor;
mod inverse_column;
mod large_front;
mod nested_dissection;
mod ordering;
mod selected_inverse;
mod substitution;
mod subtrees;
mod supernodes;
mod symbolic;
mod task;

pub(crate) use elimination::Adjacency;
pub use factor::{Breakdown, Factor};
pub use inverse_column::Workspace;
pub use selected_inverse::SelectedInverse;
pub use symbolic::Symbolic;

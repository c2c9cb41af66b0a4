//! Linear equations: the normal equations of a step, and the sparse Cholesky factorisation that solves them.
//!
//! The matrices are symmetric and made of small square blocks, one block row per pose. `ordering` permutes the variables,
//! `symbolic` works out the structure of the factor, `fronts` makes its numbers, and `normal_equations` fills the matrix.
//! Ordering, elimination tree and structure of the factor are worked out on *blocks*, 9 to 36 times fewer than scalars;
//! the numeric phase is multifrontal (Duff and Reid, "The multifrontal solution of indefinite sparse symmetric linear
//! equations", 1983), so that all arithmetic is dense. [`Symbolic`] is made once per graph and serves every block size;
//! [`Factor`] owns all memory of the numeric phase and allocates none while it works.
//!
//! Depends on the model, for the terms of the normal equations.

mod adjacency;
pub(crate) mod fronts;
pub(crate) mod normal_equations;
mod ordering;
pub(crate) mod symbolic;

pub(crate) use adjacency::Adjacency;
pub use fronts::factor::{Breakdown, Factor};
pub use symbolic::Symbolic;

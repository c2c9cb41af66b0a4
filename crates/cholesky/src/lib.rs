//! Multifrontal Cholesky factorisation of sparse symmetric matrices made of small square blocks.
//!
//! `ordering` permutes the variables, `symbolic` works out the structure of the factor, and `fronts` makes its numbers.
//! Ordering, elimination tree and structure of the factor are worked out on *blocks*, 9 to 36 times fewer than scalars;
//! the numeric phase is multifrontal (Duff and Reid, "The multifrontal solution of indefinite sparse symmetric linear
//! equations", 1983), so that all arithmetic is dense. [`Symbolic`] is made once per graph and serves every block size;
//! [`Factor`] owns all memory of the numeric phase and allocates none while it works.
//!
//! [`SelectedInverse`] has the blocks of the inverse where the factor has one, by the recursion of Takahashi, Fagan and Chen,
//! 1973, front by front; [`Factor::inverse_column`] solves for others along the elimination tree.

mod adjacency;
pub mod fronts;
mod inverse_column;
mod ordering;
mod selected_inverse;
mod symbolic;

pub use adjacency::Adjacency;
pub use fronts::factor::{Breakdown, Factor};
pub use inverse_column::Workspace;
pub use selected_inverse::SelectedInverse;
pub use symbolic::Symbolic;

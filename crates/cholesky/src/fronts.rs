//! Fronts: the numeric phase. It is multifrontal, so that all arithmetic is dense.
//!
//! Duff and Reid, "The multifrontal solution of indefinite sparse symmetric linear equations", 1983. A front is assembled
//! from the matrix and the update matrices of its children (`task`, `extend_add`). Its columns are eliminated (`dense`,
//! `large_front`), and the rest is its own update matrix. `view` is a front's memory during this, `factor` owns the memory,
//! and `substitution` solves with the factor, front by front.
//!
//! Depends on `symbolic`.

pub(crate) mod breakdown;
mod dense;
mod extend_add;
pub(crate) mod factor;
mod large_front;
mod product;
pub(crate) mod stored;
pub(crate) mod substitution;
mod task;
mod view;
mod workspaces;

pub use dense::{Scratch, eliminate, products};
pub use extend_add::{Run, extend_add, push_rows};
pub use stored::Stored;
pub use view::FrontView;

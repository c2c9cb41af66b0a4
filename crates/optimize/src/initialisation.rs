//! Initial guesses that do not depend on the given poses, except for those of the first nodes, and whether the given poses need any.
//!
//! `chordal` finds all rotations by one linear least-squares problem, then all translations by another (Carlone, Tron,
//! Daniilidis, Dellaert, ICRA 2015, section III.B); `tree` composes poses along a spanning tree; `alignment` moves a start
//! rigidly to the priors; `windings` tests the rotations of given poses. Depends on the model and on `normal_equations`.

pub(crate) mod alignment;
pub(crate) mod chordal;
pub(crate) mod tree;
pub(crate) mod windings;

pub use tree::spanning_tree;

//! Initial guesses that do not depend on the given poses, save those of the first nodes.

pub(crate) mod chordal;
pub(crate) mod tree;

pub use tree::spanning_tree;

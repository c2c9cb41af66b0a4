//! Costs of landmark edges, from the support that they give each other.
//!
//! The paper's cost of an edge is +1 with a support edge and -1 without: [`support`] counts the landmark edges between
//! neighbouring frames, within the distance of [`delta`]. Depends on no other module of this crate.

pub mod delta;
pub mod support;

//! Fill-reducing orders of the variables.
//!
//! [`minimum_degree`]: approximate minimum degree (Amestoy, Davis and Duff, 1996). [`nested_dissection`]: separators last (A.
//! George, "Nested dissection of a regular finite element mesh", 1973). [`symbolic`](super::symbolic) takes the order that
//! needs fewer operations.
//!
//! Depends only on adjacency lists.

pub(crate) mod minimum_degree;
pub(crate) mod nested_dissection;

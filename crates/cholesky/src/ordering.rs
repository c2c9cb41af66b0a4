//! Orders of the variables in which elimination fills in little.
//!
//! [`minimum_degree`]: approximate minimum degree (Amestoy, Davis and Duff, 1996). [`nested_dissection`]: separators last (A.
//! George, "Nested dissection of a regular finite element mesh", 1973). [`symbolic`](super::symbolic) takes the cheaper one.
//!
//! Depends on adjacency lists alone.

pub(crate) mod minimum_degree;
pub(crate) mod nested_dissection;

//! Fill-reducing orders of the variables.
//!
//! [`minimum_degree`]: approximate minimum degree (Amestoy, Davis and Duff, 1996). [`nested_dissection`]: separators last (A.
//! George, "Nested dissection of a regular finite element mesh", 1973). [`symbolic`](super::symbolic) tries the
//! second where the first needs many operations.
//!
//! Nested dissection takes a [`graph`] apart at the separator of a [`cut`], which [`refinement`] improves, and orders small parts by
//! [`exact_minimum_degree`].

mod cut;
mod exact_minimum_degree;
mod graph;
pub(crate) mod minimum_degree;
pub(crate) mod nested_dissection;
mod refinement;

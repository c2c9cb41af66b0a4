//! Signed graphs: the instance to cut, and the forms in which the solver works on it.
//!
//! A graph has nodes, and edges with a cost `c` for cutting them. A set of edges is a multicut if and only if no cycle meets
//! it in exactly one edge (Chopra, Rao 1993). [`instance`] is the caller's graph, [`read`] and [`generate`] make one;
//! [`signed_graph`] shrinks as reductions contract it, [`kernel`] numbers the edges of what they leave, and
//! [`cluster_graph`] sums the costs between clusters.
//!
//! Depends on no other module of this crate.

pub(crate) mod canonical;
pub(crate) mod cluster_graph;
pub(crate) mod error;
pub mod generate;
pub(crate) mod instance;
pub(crate) mod kernel;
pub(crate) mod read;
pub(crate) mod signed_graph;
pub(crate) mod sum;
pub(crate) mod union_find;

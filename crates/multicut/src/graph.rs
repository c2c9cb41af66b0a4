//! Signed graphs: the instance to cut, and the representations that the solver works on.
//!
//! A graph has nodes, and edges with a cost `c` for cutting them. A set of edges is a multicut if and only if no cycle meets
//! it in exactly one edge (Chopra, Rao 1993). [`instance`] is the caller's graph, which [`read`] reads and [`generate`]
//! generates. [`signed_graph`] shrinks while reductions contract it, [`kernel`] numbers the edges that they leave, and
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
pub mod small_and_hard;
pub(crate) mod sum;
pub(crate) mod union_find;

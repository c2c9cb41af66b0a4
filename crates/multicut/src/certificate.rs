//! Certificates: proofs of lower bounds as text, and an independent check of them.
//!
//! A proof is a tree of reductions, packings, nodes joined by the capacity left between them, and branches. Take a packing that leaves
//! the capacity `r_e` at each edge. A multicut that separates two nodes costs at least the packing's bound plus the least cut between
//! them with these capacities (docs/method.md of this crate, "Why nodes may be joined"). [`proof`] writes a certificate, [`tree`] its
//! proofs by cases, [`verify`] checks it.
//!
//! [`proof`] depends on [`reduce`](crate::reduce) and [`bound`](crate::bound). [`verify`] depends on the instance alone, and
//! shares no algorithm with the solver.

pub(crate) mod proof;
pub(crate) mod tree;
pub(crate) mod verify;

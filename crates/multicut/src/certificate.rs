//! Certificates: proofs of lower bounds as text, and an independent check of them.
//!
//! A proof is a tree of reductions, packings, edges fixed by residual cost, and branches. For a packing with weights `w_q`
//! that leaves `r_e` of the capacity of each edge, a multicut that pays for `f` costs the packing's bound plus `r_f` at least
//! (docs/method.md of this crate, "Why edges may be fixed"). [`proof`] writes it, [`verify`] checks it.
//!
//! [`proof`] depends on [`reduce`](crate::reduce) and [`bound`](crate::bound); [`verify`] on the instance alone: it shares
//! no algorithm with the solver.

pub(crate) mod proof;
pub(crate) mod verify;

//! Heuristics: good multicuts without a proof.
//!
//! [`greedy`] contracts (GAEC: Keuper et al., ICCV 2015, algorithm 2; greedy fixation: Levinkov, Kirillov, Andres, GCPR
//! 2017), [`kernighan_lin`] exchanges nodes between clusters and joins them (KLj: Keuper et al., ICCV 2015, algorithm 1),
//! [`node_moves`] moves single nodes, [`local_search`] fuses proposals (Beier, Hamprecht, Kappes, CVPR 2015), [`bisection`]
//! starts long graphs, [`segmentation`] cuts a sequence of nodes ([`band_order`], made shorter by [`linear_arrangement`]) into the
//! best segments, [`start`] combines them on a kernel, and [`annealing`] improves solutions of small ones.
//!
//! Depends on [`graph`](crate::graph), and on [`reduce`](crate::reduce) for the contracted graphs of fusions.

pub(crate) mod annealing;
pub(crate) mod band_order;
pub(crate) mod bisection;
pub(crate) mod contraction_queue;
pub(crate) mod greedy;
pub(crate) mod kernighan_lin;
pub(crate) mod linear_arrangement;
pub(crate) mod local_search;
pub(crate) mod node_moves;
pub(crate) mod segmentation;
pub(crate) mod start;

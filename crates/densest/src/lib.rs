//! The weighted densest clique of the consistency graph, in the manner of CLIPPER (Lusk, Fathian, How, "CLIPPER: a
//! graph-theoretic framework for robust data association", ICRA 2021).
//!
//! PCM keeps the *largest* set of pairwise consistent landmark edges; this method keeps the one that agrees *best*. Each
//! consistent pair has a weight between 0 and 1 that measures how well it agrees. The result is the clique S whose weight
//! matrix has the largest eigenvalue (CLIPPER's densest subgraph, relaxed; the maximum spectral radius clique of CLIPPER+,
//! Fathian, Summers, RA-L 2024):
//!
//! ```text
//! maximise u^T M u   over   |u| = 1, u >= 0, u_i u_j = 0 where i and j are inconsistent
//! ```
//!
//! with `M_ii = 1` and `M_ij` the weight of a pair. With weights of 1 the value of a clique is its size.
//!
//! - [`affinity`]: the matrix M of the consistent pairs, sparse.
//! - [`ascent`]: projected gradient ascent with a growing penalty on inconsistent pairs.
//! - [`clique`]: from the relaxed solution to a maximal clique and its value.
//! - [`stage`]: the whole method on a pose graph.

pub mod affinity;
pub mod ascent;
#[cfg(feature = "cli")]
pub mod cli;
pub mod clique;
#[cfg(feature = "cli")]
pub mod stage;

pub use affinity::Affinity;
pub use clique::{Densest, densest_clique};
#[cfg(feature = "cli")]
pub use stage::{Options, Select, Weight};

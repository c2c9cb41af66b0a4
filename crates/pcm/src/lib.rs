//! Pairwise consistency maximisation (Mangelson, Dominic, Eustice, Vasudevan, ICRA 2018): two landmark edges
//! are consistent if the loop through both and the odometry between them closes within its covariance; the
//! largest set of edges that are consistent with each other, a maximum clique, is kept.
//!
//! - [`chain`]: poses and covariances accumulated along the odometry, so that any stretch costs O(1).
//! - [`candidate`]: landmark edges between the same two chains, oriented alike.
//! - [`consistency`]: the Mahalanobis distance of a pair of candidates, and the graph of consistent pairs.
//! - [`clique`]: the maximum clique, with a proof or an upper bound.
//! - [`stage`]: all of it on a pose graph.

pub mod candidate;
pub mod chain;
pub mod clique;
pub mod consistency;
mod error;
mod gate;
pub mod stage;

pub use error::PcmError;
pub use gate::{Gate, Test};
pub use stage::Options;

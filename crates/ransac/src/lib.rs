//! RANSAC over landmark edges (Fischler, Bolles, Communications of the ACM 24(6), 1981). It draws sets of a few landmark
//! edges at random. Each set votes for the edges that agree with all its members, and the largest vote, the *consensus
//! set*, is kept.
//!
//! - [`consensus`]: the search, for any test of whether two candidates agree.
//! - [`stage`]: the search on the landmark edges of a pose graph, where agreement is PCM's chi-square test of the loop
//!   through both edges and the odometry between them ([`posecut_pcm::consistency`]).

#[cfg(feature = "cli")]
pub mod cli;
pub mod consensus;
#[cfg(feature = "cli")]
pub mod stage;

pub use consensus::{Consensus, Search, largest_consensus};
#[cfg(feature = "cli")]
pub use stage::Options;

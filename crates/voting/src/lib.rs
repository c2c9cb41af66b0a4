//! Cluster voting in the manner of RRR (Latif, Cadena, Neira, "Robust loop closing over time for pose graph SLAM", IJRR
//! 32(14), 2013): landmark edges are clustered by the frames they join, and clusters are kept if the graph optimised with them
//! passes chi-square tests, each by itself and then together.
//!
//! - [`mod@vote`]: the tests, on anything that can be optimised over a choice of landmark edges.
//! - [`election`]: in which order clusters are put together.
//! - [`fit`]: the optimisation of a pose graph over its odometry and chosen landmark edges.
//! - [`stage`]: both on a pose graph.
//!
//! Clusters are those of [`posecut_islands`].

mod chains;
pub mod election;
pub mod fit;
pub mod forecast;
#[cfg(feature = "cli")]
pub mod stage;
pub mod vote;

pub use election::Election;
pub use forecast::Forecast;
#[cfg(feature = "cli")]
pub use stage::Options;
pub use vote::{Fit, Optimiser, Quantiles, Verdict, vote};

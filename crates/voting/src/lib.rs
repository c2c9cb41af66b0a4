//! Cluster voting in the manner of RRR (Latif, Cadena, Neira, "Robust loop closing over time for pose graph SLAM", IJRR
//! 32(14), 2013). Landmark edges are clustered by the frames they join. Clusters are kept if the graph optimised with them
//! passes chi-square tests, first each cluster by itself and then all together.
//!
//! - [`mod@vote`]: the tests, for any problem that can be optimised over a choice of landmark edges.
//! - [`election`]: the order in which clusters are combined.
//! - [`fit`]: the optimisation of a pose graph over its odometry and chosen landmark edges.
//! - [`stage`]: both for a pose graph.
//!
//! Clusters come from [`posecut_islands`].

mod chains;
#[cfg(feature = "cli")]
pub mod cli;
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

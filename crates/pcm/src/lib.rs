//! Pairwise consistency maximisation (Mangelson, Dominic, Eustice, Vasudevan, ICRA 2018): two landmark edges
//! are consistent if the loop through both and the odometry between them closes within its covariance; the
//! largest set of edges that are consistent with each other, a maximum clique, is kept.
//!
//! - [`chain`]: poses and covariances accumulated along the odometry, so that any stretch costs O(1).
//! - [`candidate`]: landmark edges between the same two chains, oriented alike.
//! - [`distance`]: the Mahalanobis distance of a pair of candidates.
//! - [`pretest`]: bounds that most inconsistent pairs fail at a fraction of the cost.
//! - [`consistency`]: the graph of consistent pairs.
//! - [`clique`]: the maximum clique, with a proof or an upper bound.
//! - [`cells`]: the same for more candidates than a matrix of all pairs can hold.
//! - [`chance`]: how many edges between random places would agree as well.
//! - [`growth`]: candidates that a clique lost by a pair or two.
//! - [`calibration`]: how far the covariances are off, from the candidates themselves.
//! - [`readmission`]: every edge against the map that the others make.
//! - [`incremental`]: candidates one by one.
//! - [`stage`]: all of it on a pose graph.

mod block;
mod budget;
pub mod calibration;
pub mod candidate;
pub mod cells;
pub mod chain;
pub mod chance;
pub mod clique;
pub mod consistency;
pub mod dimacs;
pub mod distance;
mod error;
mod gate;
pub mod generate;
pub mod growth;
pub mod incremental;
mod islands;
mod judgement;
pub mod lanes;
mod logarithm;
pub mod nearest;
mod options;
pub mod pretest;
pub mod readmission;
pub mod replay;
pub mod selection;
mod spread;
pub mod stage;
mod summary;

pub use error::PcmError;
pub use gate::{Correction, Gate, PerStep, Test, chi_square_quantile, corrected};
pub use options::{Options, Scale, Scheme};
pub use spread::Spatial;

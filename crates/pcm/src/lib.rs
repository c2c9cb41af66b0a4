//! Pairwise consistency maximisation (Mangelson, Dominic, Eustice, Vasudevan, ICRA 2018): two landmark edges
//! are consistent if the loop through both and the odometry between them closes within its covariance; the
//! largest set of edges that are consistent with each other, a maximum clique, is kept.
//!
//! A folder of `src` is a piece of theory; the module of its name says which equations it rests on:
//!
//! - `odometry`: [`chain`], poses and covariances accumulated along the odometry, so that any stretch costs O(1).
//! - `pairs`: [`candidate`], landmark edges between the same two chains, oriented alike; [`distance`], the Mahalanobis
//!   distance of a pair; [`Gate`], how far apart a consistent pair may be; [`pretest`], bounds that most inconsistent pairs
//!   fail at a fraction of the cost; [`consistency`], the graph of consistent pairs.
//! - [`clique`]: the maximum clique, with a proof or an upper bound.
//! - [`chance`]: how many edges between random places would agree as well.
//! - [`calibration`]: how far the covariances are off, from the candidates themselves.
//! - `judgement`: what becomes of a group; [`cells`], the same for more candidates than a matrix of all pairs can
//!   hold; [`growth`], candidates that a clique lost by a pair or two.
//! - `stage`: the program, with the feature `cli`.
//!
//! Files of their own are `rejection`, all of it on a pose graph ([`reject`]), with its `options`, the `budget` of its groups and
//! their `preparation`; [`replay`], what it decides on, for those who show it; [`incremental`], candidates one by one; and
//! [`generate`], graphs for tests.

mod budget;
pub mod calibration;
pub mod chance;
pub mod clique;
mod error;
pub mod generate;
pub mod incremental;
mod judgement;
mod odometry;
mod options;
mod pairs;
mod preparation;
mod rejection;
pub mod replay;
#[cfg(feature = "cli")]
pub mod stage;

pub use clique::dimacs;
pub use error::PcmError;
pub use judgement::{cells, figures, growth};
pub use odometry::chain;
pub use odometry::spread::Spatial;
pub use options::{Options, Scale, Scheme};
pub use pairs::gate::{Correction, Gate, PerStep, Test, chi_square_quantile, corrected};
pub use pairs::{candidate, consistency, distance, lanes, nearest, pretest};
pub use rejection::{Calibration, Progress, Rejection, reject};

/// The stage's name, in histories and in `rejected_by`.
pub const STAGE: &str = "pcm";

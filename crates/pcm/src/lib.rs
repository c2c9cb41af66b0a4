//! Pairwise consistency maximisation (Mangelson, Dominic, Eustice, Vasudevan, ICRA 2018). Two landmark edges are consistent
//! if the loop through both and the odometry between them closes within its covariance. PCM keeps the largest set of edges
//! that are consistent with each other, a maximum clique.
//!
//! Each folder of `src` covers one part of the theory; the module of the same name cites its equations:
//!
//! - `odometry`: [`chain`], poses and covariances accumulated along the odometry, so that any stretch costs O(1).
//! - `pairs`: [`candidate`], landmark edges between the same two chains, oriented alike; [`distance`], the Mahalanobis
//!   distance of a pair; [`Gate`], how far apart a consistent pair may be; [`pretest`], bounds that most inconsistent pairs
//!   fail at a fraction of the cost; [`consistency`], the graph of consistent pairs.
//! - [`clique`]: the maximum clique, with a proof or an upper bound.
//! - [`chance`]: how many edges between random positions would agree as well.
//! - [`calibration`]: by which factors the covariances are wrong, from the candidates themselves.
//! - `judgement`: which candidates of a group are kept; [`cells`], the same for more candidates than a matrix of all pairs
//!   can hold; [`growth`], candidates that are missing from a clique because of a pair or two.
//! - `stage`: the program, with the feature `cli`.
//!
//! Some files have no folder: `rejection`, all of it on a pose graph ([`reject`]), with its `options`, the `budget` of its
//! groups and their `preparation`; [`replay`], the data that it decides on, for programs that display them;
//! [`incremental`], candidates one by one; and [`generate`], graphs for tests.

mod budget;
pub mod calibration;
pub mod chance;
#[cfg(feature = "cli")]
pub mod cli;
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
pub use pairs::{candidate, consistency, distance, nearest, pretest};
pub use rejection::{Calibration, Progress, Rejection, reject};

/// The stage's name, in histories and in `rejected_by`.
pub const STAGE: &str = "pcm";

//! Judges every landmark edge of a pose graph by evidence: log-likelihood ratios of correct candidates against chance, a
//! minimum-cost multicut over the candidates, and the map of the accepted ones.
//!
//! - `model`: chains, candidates, and the loops that they close with their covariances.
//! - `evidence`: log-likelihood ratios of a loop.
//! - `calibration`, `mixture`, `neighbours`: factors on the covariances of each chain, estimated in contrast to shuffled
//!   candidates.
//! - `renumber`: an order of nodes that does not depend on their ids.
//! - `partners`, `cut`: the pairs that are compared, and the multicut of the graph of evidence.
//! - `judge`, `islands`, `rounds`, `map`: hypotheses, and rounds of optimisation and verdicts.
//! - `prior`: the share of correct candidates where the map is uncertain.
//! - `scores`: scores of a front end, with weights learnt from the graph.
//! - `usual`, `bridges`: the usual motion of a robot, where odometry is missing.
//! - `breaks`: broken odometry, which correct edges contradict; `slips`, `spans`: the same where no accepted loop spans it.
//! - `ingredients`: the ingredients that can be left out, to measure their worth.
//! - `joins`, `rivals`, `lone`: which hypotheses join components, other ways to join two chains, and groups that alone join them.
//! - [`verdict`], [`stage`]: the verdict on every edge, and the stage on a pose graph.

mod agreement;
mod ascent;
mod breaks;
mod bridges;
mod calibration;
mod chance;
#[cfg(feature = "cli")]
pub mod cli;
mod cut;
mod evidence;
mod factors;
mod first_pass;
mod ingredients;
mod islands;
mod joins;
mod judge;
mod likelihoods;
mod lone;
mod map;
mod mixture;
mod model;
mod neighbours;
mod packs;
mod partners;
mod prior;
mod renumber;
mod rivals;
mod rounds;
mod scores;
mod slips;
mod spans;
#[cfg(feature = "cli")]
pub mod stage;
mod translation;
mod trials;
mod usual;
pub mod verdict;
mod verification;

pub use calibration::Calibration;
pub use ingredients::Ingredient;
pub use model::Motion;
pub use rivals::Rival;
#[cfg(feature = "cli")]
pub use stage::{Options, Undecided};
pub use verification::{Verification, verify, verify_by};

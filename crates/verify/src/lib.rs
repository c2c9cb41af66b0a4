//! Judges every landmark edge of a pose graph by evidence: log-likelihood ratios between candidates, correct against
//! chance, a minimum-cost multicut over the candidates, and the map that the accepted ones make.
//!
//! - `model`: chains, candidates, and the loops that they close with their covariances.
//! - `evidence`: log-likelihood ratios of a loop.
//! - `calibration`, `mixture`, `neighbours`: factors on the covariances, for each chain, against shuffled candidates.
//! - `renumber`: the order of nodes, whatever their ids.
//! - `partners`, `cut`: which pairs are compared, and the multicut of the graph of evidence.
//! - `judge`, `islands`, `rounds`, `map`: hypotheses, and rounds of optimisation and verdicts.
//! - `prior`: how many candidates are correct where the map says little.
//! - `usual`, `bridges`: where odometry is missing, how far the robot usually moves in such a time.
//! - `breaks`: where odometry is broken, so that correct edges contradict it.
//! - `ingredients`: what can be left out, to see what it is worth.
//! - `rivals`: other ways to join two chains.
//! - [`verdict`], [`stage`]: what is said of every edge, on a pose graph.

mod agreement;
mod breaks;
mod bridges;
mod calibration;
mod cut;
mod evidence;
mod first_pass;
mod ingredients;
mod islands;
mod judge;
mod likelihoods;
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
#[cfg(feature = "cli")]
pub mod stage;
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

//! Judges every landmark edge of a pose graph by evidence.

mod calibration;
mod cut;
mod evidence;
mod judge;
mod map;
mod model;
mod partners;
pub mod stage;

pub use model::Motion;
pub use stage::Options;

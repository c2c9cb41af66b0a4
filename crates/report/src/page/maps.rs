//! Maps of laser logs: occupancy grids before, with all candidates in use, and after rejection, with the candidates on them.
//!
//! They are drawn from the graphs themselves, so that picture and edges always fit. All of one log have cells of the same size.

mod candidates;
mod errors;
mod folder;
mod table;

use serde::Serialize;

use super::view::Track;

pub use candidates::{Candidates, Counts};
pub use errors::RelationErrors;
pub use folder::read;
pub use table::table;

/// Positions on these maps are rounded to this, metres: a fifth of a cell.
pub const MAP_STEP: f64 = 0.01;

/// The maps of one log.
#[derive(Clone, Debug, Serialize)]
pub struct LogMaps {
    /// The name of the folder.
    pub name: String,
    /// Side of a cell, metres.
    pub resolution: f64,
    /// The landmark edges that place recognition proposed.
    pub candidates: Candidates,
    /// By odometry alone.
    pub before: LogMap,
    /// With all candidates in use; absent if nothing rejected any.
    pub all_candidates: Option<LogMap>,
    /// Without the rejected candidates.
    pub after: LogMap,
}

/// One map.
#[derive(Clone, Debug, Serialize)]
pub struct LogMap {
    /// The grid as PNG in base 64, of [`posecut_map::write_opacity`].
    pub picture: String,
    /// Corner of the picture at the least x and y, metres.
    pub corner: [f64; 2],
    /// Width and height of the picture, metres.
    pub size: [f64; 2],
    /// Positions of the nodes, x to the right and y upwards, in steps of [`MAP_STEP`].
    pub track: Track,
    /// Errors of its relative motions; absent without measured relations.
    #[serde(skip)]
    pub errors: Option<RelationErrors>,
}

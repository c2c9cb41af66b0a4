//! How g2o and TORO are read, and what the reader did.

use std::collections::BTreeMap;

use crate::information::Repair;
use crate::odometry::{NextIds, Odometry};

/// How to treat imperfect input.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// The session of vertices whose id has no robot's letter.
    pub session: String,
    /// How to repair information matrices that are not positive semidefinite.
    pub repair: Repair,
    /// Skip lines with an unknown tag instead of refusing them.
    pub skip_unknown: bool,
    /// Which edges are odometry.
    pub odometry: Odometry,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            session: "0".to_owned(),
            repair: Repair::Refuse,
            skip_unknown: false,
            odometry: Odometry::Auto,
        }
    }
}

/// What the reader repaired, skipped or added.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadSummary {
    /// Information matrices that were repaired.
    pub repaired: usize,
    /// Information matrices that are indistinguishable from singular ones, given the rounding of their printed terms.
    pub open: usize,
    /// Line and vertices of the first such matrix.
    pub first_open: Option<(u64, u64, u64)>,
    /// Number of skipped lines, by tag.
    pub skipped: BTreeMap<String, usize>,
    /// Number of nodes that have no vertex line, only edges.
    pub without_vertex: usize,
    /// Odometry that was found by the next id, of each robot without consecutive ids.
    pub next_ids: Vec<NextIds>,
}

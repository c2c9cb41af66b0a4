//! g2o pose graphs.
//!
//! Edges between one vertex and the next (ids n and n + 1, the first edge of such a pair) are odometry, all
//! others landmark edges. An id whose top byte is a letter is gtsam's symbol of a robot: the letter names the
//! session and the rest is the frame; other vertices belong to session `0`, or the name given.

mod read;
mod write;

pub(crate) use read::{Dialect, read_dialect};
pub use read::{ReadOptions, ReadSummary, read};
pub use write::{WriteSummary, write};

/// The field of a node that `FIX` sets.
pub(crate) const FIXED: &str = "fixed";

//! Islands: landmark edges that come in runs of consecutive frames are kept, lone ones are rejected.
//!
//! Place recognition by bags of words accepts a match only if the frames before it have matches near the same position.
//! Matches of a query to frames close in time form an *island*, and an island must be found again for several consecutive
//! queries (Gálvez-López, Tardós, "Bags of binary words for fast place recognition in image sequences", IEEE T-RO 28(5),
//! 2012, sections V.B and V.C). Here the whole sequence is known, so a run may extend in both directions.
//!
//! - [`cluster`]: landmark edges with neighbouring frames at both ends, joined into islands. Needs no measurement.
//! - [`stage`]: which islands are long enough, on a pose graph.

#[cfg(feature = "cli")]
pub mod cli;
pub mod cluster;
#[cfg(feature = "cli")]
pub mod stage;

pub use cluster::{FrameError, Match, clusters, matches};
#[cfg(feature = "cli")]
pub use stage::Options;

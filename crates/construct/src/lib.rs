//! Construction of a multi-session pose graph (PGC in the paper): experiences side by side, correct landmark
//! edges between viewpoints whose ground truth is spatially similar, and incorrect ones added at random.
//!
//! This stage writes and reads `truth`; stages that estimate never read it.

#[cfg(feature = "cli")]
pub mod cli;
mod correct;
mod error;
mod gaps;
mod incorrect;
mod join;
mod landmark;
mod matches;
mod noise;
mod options;
mod split;
mod viewpoint;

pub use error::ConstructError;
pub use gaps::cut_odometry;
pub use incorrect::IncorrectKind;
pub use join::join;
pub use landmark::{Counts, add_landmark_edges};
pub use matches::{Frame, Match, MatchMeasurement, add_matches, read_matches};
pub use noise::NoiseKind;
pub use options::{Options, Split};
pub use split::split_at_middle;

use posecut_graph::PoseGraph;

/// The source of landmark edges.
#[derive(Clone, Debug)]
pub enum Landmarks {
    /// Ground truth: correct and incorrect edges are made from it.
    Truth,
    /// A place recogniser's matches.
    Matches {
        /// The name of the list in messages.
        file: String,
        /// The matches.
        matches: Vec<Match>,
    },
}

/// A multi-session graph, and what was added to the sessions.
#[derive(Clone, Debug)]
pub struct Construction {
    /// The graph.
    pub graph: PoseGraph,
    /// Chains of odometry after gaps were cut; `None` if none were to be cut.
    pub chains: Option<usize>,
    /// Its landmark edges.
    pub counts: Counts,
}

/// Builds the multi-session graph from session graphs. O(nodes + landmark edges).
pub fn construct(
    graphs: Vec<PoseGraph>,
    landmarks: &Landmarks,
    options: &Options,
) -> Result<Construction, ConstructError> {
    options.check()?;
    let mut graph = join(graphs)?;
    if options.split.applies(graph.sessions().len()) {
        split_at_middle(&mut graph)?;
    }
    let chains = if options.odometry_gaps > 0 {
        Some(cut_odometry(&mut graph, options.odometry_gaps, options.seed)?)
    } else {
        None
    };
    let counts = match landmarks {
        Landmarks::Truth => add_landmark_edges(&mut graph, options)?,
        Landmarks::Matches { file, matches } => add_matches(&mut graph, file, matches, options)?,
    };
    Ok(Construction { graph, chains, counts })
}

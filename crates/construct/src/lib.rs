//! Construction of a multi-session pose graph (PGC in the paper): experiences side by side, correct landmark
//! edges between viewpoints whose ground truth is spatially similar, and incorrect ones added at random.
//!
//! This stage writes and reads `truth`; stages that estimate never read it.

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
pub use landmark::add_landmark_edges;
pub use matches::{Frame, Match, MatchMeasurement, add_matches, read_matches};
pub use noise::NoiseKind;
pub use options::{Options, Split};
pub use split::split_at_middle;

use posecut_graph::PoseGraph;
use posecut_stage::Statistics;

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

/// Builds the multi-session graph from session graphs. O(nodes + landmark edges).
pub fn construct(
    graphs: Vec<PoseGraph>,
    landmarks: &Landmarks,
    options: &Options,
) -> Result<(PoseGraph, Statistics), ConstructError> {
    options.check()?;
    let mut graph = join(graphs)?;
    if options.split.applies(graph.sessions().len()) {
        split_at_middle(&mut graph)?;
    }
    let mut statistics = Statistics::default();
    if options.odometry_gaps > 0 {
        let chains = cut_odometry(&mut graph, options.odometry_gaps, options.seed)?;
        statistics.note("odometry_gaps", options.odometry_gaps);
        statistics.note("chains", chains);
    }
    match landmarks {
        Landmarks::Truth => add_landmark_edges(&mut graph, options, &mut statistics)?,
        Landmarks::Matches { file, matches } => {
            add_matches(&mut graph, file, matches, options, &mut statistics)?;
        }
    }
    Ok((graph, statistics))
}

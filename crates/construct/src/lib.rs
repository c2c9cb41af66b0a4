//! Construction of a multi-session pose graph (PGC in the paper): experiences side by side, correct landmark
//! edges between viewpoints whose ground truth is spatially similar, and incorrect ones added at random.
//!
//! This is where `truth` is written and read; stages that estimate never look at it.

mod correct;
mod error;
mod incorrect;
mod join;
mod landmark;
mod options;
mod split;

pub use error::ConstructError;
pub use join::join;
pub use landmark::add_landmark_edges;
pub use options::{Options, Split};
pub use split::split_at_middle;

use posecut_graph::PoseGraph;
use posecut_stage::Statistics;

/// Builds the multi-session graph from session graphs. O(nodes + landmark edges).
pub fn construct(
    graphs: Vec<PoseGraph>,
    options: &Options,
) -> Result<(PoseGraph, Statistics), ConstructError> {
    options.check()?;
    let mut graph = join(graphs)?;
    if options.split.applies(graph.sessions().len()) {
        split_at_middle(&mut graph)?;
    }
    let mut statistics = Statistics::default();
    add_landmark_edges(&mut graph, options, &mut statistics)?;
    Ok((graph, statistics))
}

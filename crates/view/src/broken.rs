//! Odometry that cannot be trusted: rejected by a stage, or broken by what verification found.

use posecut_graph::{Edge, EdgeKind, PoseGraph};
use serde::Serialize;

use crate::columns::shortened;
use crate::verification::Verification;

/// Most such edges that a page shows.
const MOST: usize = 10_000;

/// An odometry edge, with the reason why it is marked.
#[derive(Debug, Serialize)]
pub(crate) struct Broken {
    /// As text, because an id may have more digits than a script counts.
    id: String,
    /// Indices of its nodes.
    from: usize,
    to: usize,
    why: String,
}

/// The odometry edges to mark.
pub(crate) fn broken(graph: &PoseGraph, verification: Option<&Verification>) -> Vec<Broken> {
    let why = |edge: &Edge| match (&edge.rejected_by, verification) {
        (Some(stage), _) => Some(format!("rejected by {}", shortened(stage))),
        (None, Some(found)) if found.is_broken(edge.id) => Some("broken, by verify".to_owned()),
        _ => None,
    };
    let marked = graph.edges_of(EdgeKind::Odometry).filter_map(|edge| {
        let why = why(edge)?;
        let (from, to) = graph.ends(edge)?;
        Some(Broken { id: edge.id.to_string(), from, to, why })
    });
    marked.take(MOST).collect()
}

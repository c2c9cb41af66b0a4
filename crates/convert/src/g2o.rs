//! g2o pose graphs.
//!
//! Edges between one vertex and the next (ids n and n + 1, the first edge of such a pair) are odometry, all
//! others landmark edges. An id whose top byte is a letter is gtsam's symbol of a robot: the letter names the
//! session and the rest is the frame; other vertices belong to session `0`, or the name given.
//!
//! Where that rule would call an edge by the wrong name, as for a landmark edge between two successive vertices, the
//! writer puts a comment line before it, `# FROM TO posecut landmark` or `# FROM TO posecut odometry`. Other tools skip
//! comments; the reader here heeds them. The ids come first because gtsam's reader looks for two numbers after every tag,
//! comments included, and silently drops the next edge where there are none.

mod read;
mod write;

use std::collections::HashSet;

use posecut_graph::EdgeKind;

pub(crate) use read::{Dialect, read_dialect};
pub use read::{ReadOptions, ReadSummary, read, read_several};
pub use write::{WriteSummary, write};

/// What an edge is by the ids of its vertices: the first between each vertex and its successor is odometry.
pub(crate) fn inferred_kind(successive: &mut HashSet<u64>, from: u64, to: u64) -> EdgeKind {
    let odometry = from.abs_diff(to) == 1 && successive.insert(from.min(to));
    if odometry { EdgeKind::Odometry } else { EdgeKind::Landmark }
}

/// The comment that names the kind of the next edge, which joins these vertices.
pub(crate) fn comment_of_kind(from: u64, to: u64, kind: EdgeKind) -> String {
    format!("# {from} {to} posecut {}", kind.name())
}

/// The vertices and the kind that a comment gives to the next edge.
pub(crate) fn kind_of_comment(words: &[&str]) -> Option<(u64, u64, EdgeKind)> {
    let &["#", from, to, "posecut", name] = words else { return None };
    let kind = [EdgeKind::Odometry, EdgeKind::Landmark].into_iter().find(|kind| kind.name() == name)?;
    Some((from.parse().ok()?, to.parse().ok()?, kind))
}

//! g2o pose graphs.
//!
//! Among the edges between vertices with successive ids (n and n + 1), the first of each pair is odometry; all other
//! edges are landmark edges ([`Odometry`](crate::Odometry) has other rules). An id whose top byte is a letter is gtsam's symbol of a robot: the letter is the session's
//! name and the rest is the frame. Other vertices belong to session `0`, or to the session that the caller names.
//!
//! If that rule would give an edge the wrong kind, as for a landmark edge between two successive vertices, the writer
//! puts a comment line before the edge: `# FROM TO posecut landmark` or `# FROM TO posecut odometry`. Other tools skip
//! comments; our reader uses this one. The ids come first because gtsam's reader looks for two numbers after every tag,
//! even in comments, and silently drops the next edge if there are none.

mod read;
mod write;

use posecut_graph::EdgeKind;

pub(crate) use read::{Dialect, read_dialect};
pub use read::{ReadOptions, ReadSummary, read, read_several};
pub use write::{WriteSummary, write};

/// The comment that gives the kind of the next edge, which must join these vertices.
pub(crate) fn comment_of_kind(from: u64, to: u64, kind: EdgeKind) -> String {
    format!("# {from} {to} posecut {}", kind.name())
}

/// The vertices and the kind that a comment gives to the next edge.
pub(crate) fn kind_of_comment(words: &[&str]) -> Option<(u64, u64, EdgeKind)> {
    let &["#", from, to, "posecut", name] = words else { return None };
    let kind = [EdgeKind::Odometry, EdgeKind::Landmark].into_iter().find(|kind| kind.name() == name)?;
    Some((from.parse().ok()?, to.parse().ok()?, kind))
}

//! Costs of landmark edges, from the support that they give each other.

use std::collections::{BTreeMap, HashSet};

use posecut_graph::{Edge, EdgeKind, Node, PoseGraph};

use super::delta::{Delta, spacings};

/// The reason why support cannot be counted.
#[derive(Debug, thiserror::Error)]
pub enum SupportError {
    /// An edge ends at a node without a session or a frame.
    #[error(
        "{edge}: its node {node} has no \"session\" or no \"frame\", so its neighbours are unknown; number the frames of every session, or give every landmark edge a \"cost\" and use --costs field"
    )]
    NoFrame {
        /// The edge.
        edge: String,
        /// The node.
        node: u64,
    },
}

/// A landmark edge by its ends: sessions and frames, the smaller end first.
type Ends<'a> = ((&'a str, i64), (&'a str, i64));

/// The support of the landmark edges in use.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Support {
    /// For each edge, its index in the graph and the number of its support edges.
    pub counts: Vec<(usize, usize)>,
    /// The smallest and the largest delta used, over all pairs of sessions; `None` without candidates.
    pub deltas: Option<[u32; 2]>,
}

/// For each landmark edge in use, its index in the graph and the number of its *support edges*: other pairs of frames (i',
/// j') of the same two sessions, joined by a landmark edge in use, with |i - i'| <= delta and |j - j'| <= delta. There are at
/// most 4 delta (delta + 1) of them. Several edges between the same two frames count as one pair. The direction of an edge
/// does not matter.
///
/// O(edges * min((2 delta + 1)^2, edges)).
pub fn support_counts(graph: &PoseGraph, delta: u32) -> Result<Vec<(usize, usize)>, SupportError> {
    Ok(support(graph, Delta::Frames(delta))?.counts)
}

/// Like [`support_counts`], for either kind of delta; also returns the deltas used.
pub fn support(graph: &PoseGraph, delta: Delta) -> Result<Support, SupportError> {
    let mut edges = Vec::new();
    let mut pairs: HashSet<Ends<'_>> = HashSet::new();
    for (index, edge) in graph.edges.iter().enumerate() {
        if edge.kind == EdgeKind::Landmark && edge.in_use() {
            let ends = ends(graph, edge)?;
            edges.push((index, ends));
            pairs.insert(ends);
        }
    }
    let spacings: BTreeMap<_, u32> = match delta {
        Delta::Frames(frames) => pairs.iter().map(|ends| (sessions(ends), frames)).collect(),
        Delta::Auto => spacings(frames_by_sessions(&pairs)),
    };
    let deltas = spacings.values().min().zip(spacings.values().max()).map(|(&least, &most)| [least, most]);
    let count = |ends: &Ends<'_>| supporting(&pairs, ends, spacings[&sessions(ends)]);
    Ok(Support { counts: edges.iter().map(|(index, ends)| (*index, count(ends))).collect(), deltas })
}

fn sessions<'a>(ends: &Ends<'a>) -> (&'a str, &'a str) {
    (ends.0.0, ends.1.0)
}

/// The frames of candidates at either end, for each pair of sessions.
fn frames_by_sessions<'a>(pairs: &HashSet<Ends<'a>>) -> BTreeMap<(&'a str, &'a str), [Vec<i64>; 2]> {
    let mut frames: BTreeMap<_, [Vec<i64>; 2]> = BTreeMap::new();
    for ends in pairs {
        let [first, second] = frames.entry(sessions(ends)).or_default();
        first.push(ends.0.1);
        second.push(ends.1.1);
    }
    frames
}

/// The number of other pairs of frames within `delta` of these.
fn supporting(pairs: &HashSet<Ends<'_>>, (first, second): &Ends<'_>, delta: u32) -> usize {
    let reach = i64::from(delta);
    let window = (2 * reach + 1).saturating_mul(2 * reach + 1);
    // If the window has more positions than there are edges, go through the edges instead.
    if window > pairs.len() as i64 {
        let near = |(a, b): &&Ends<'_>| {
            a.0 == first.0
                && b.0 == second.0
                && a.1.abs_diff(first.1) <= u64::from(delta)
                && b.1.abs_diff(second.1) <= u64::from(delta)
        };
        return pairs.iter().filter(near).count() - 1;
    }
    let found = |(di, dj): &(i64, i64)| {
        let (i, j) = (first.1.saturating_add(*di), second.1.saturating_add(*dj));
        pairs.contains(&((first.0, i), (second.0, j)))
    };
    (-reach..=reach).flat_map(|di| (-reach..=reach).map(move |dj| (di, dj))).filter(found).count() - 1
}

fn ends<'a>(graph: &'a PoseGraph, edge: &Edge) -> Result<Ends<'a>, SupportError> {
    let end = |id: u64| {
        let node = graph.node_index(id).map(|index| &graph.nodes[index]);
        node.and_then(Node::session_frame)
            .ok_or_else(|| SupportError::NoFrame { edge: edge.name(), node: id })
    };
    let (from, to) = (end(edge.from)?, end(edge.to)?);
    Ok(if from <= to { (from, to) } else { (to, from) })
}

//! Costs of landmark edges by the support they find in each other.

use std::collections::HashSet;

use posecut_graph::{Edge, EdgeKind, PoseGraph};

/// Why support cannot be counted.
#[derive(Debug, thiserror::Error)]
pub enum SupportError {
    /// An edge ends at a node that has no place in a session.
    #[error(
        "{edge}: its node {node} has no \"session\" or no \"frame\", so its neighbours are unknown; number the frames of every session, or give costs in the file and say --costs field"
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

/// For each landmark edge in use, its place among the graph's edges and the number of its *support edges*:
/// other pairs of frames (i', j') of the same two sessions, joined by a landmark edge in use, with
/// |i - i'| <= delta and |j - j'| <= delta. At most 4 delta (delta + 1) of them; several edges between the same
/// two frames are one pair. An edge stored the other way round counts the same.
///
/// O(edges * min((2 delta + 1)^2, edges)).
pub fn support_counts(graph: &PoseGraph, delta: u32) -> Result<Vec<(usize, usize)>, SupportError> {
    let mut edges = Vec::new();
    let mut pairs: HashSet<Ends<'_>> = HashSet::new();
    for (index, edge) in graph.edges.iter().enumerate() {
        if edge.kind == EdgeKind::Landmark && edge.in_use() {
            let ends = ends(graph, edge)?;
            edges.push((index, ends));
            pairs.insert(ends);
        }
    }
    let reach = i64::from(delta);
    let window = (2 * reach + 1).saturating_mul(2 * reach + 1);
    let count = |(first, second): &Ends<'_>| {
        // A window wider than the number of edges is searched from the other side.
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
    };
    Ok(edges.iter().map(|(index, ends)| (*index, count(ends))).collect())
}

fn ends<'a>(graph: &'a PoseGraph, edge: &Edge) -> Result<Ends<'a>, SupportError> {
    let end = |id: u64| {
        let node = graph.node_index(id).map(|index| &graph.nodes[index]);
        node.and_then(|node| Some((node.session.as_deref()?, node.frame?)))
            .ok_or_else(|| SupportError::NoFrame { edge: edge.name(), node: id })
    };
    let (from, to) = (end(edge.from)?, end(edge.to)?);
    Ok(if from <= to { (from, to) } else { (to, from) })
}

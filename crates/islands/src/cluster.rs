//! Landmark edges as points in the plane of frames, and their clusters.

use std::collections::HashMap;

use petgraph::unionfind::UnionFind;
use posecut_graph::{Edge, EdgeKind, PoseGraph};

/// Why an edge has no position in the plane of frames.
#[derive(Debug, thiserror::Error)]
pub enum FrameError {
    /// An edge ends at a node without a session or a frame.
    #[error(
        "{edge}: its node {node} has no \"session\" or no \"frame\", so its neighbouring edges cannot be found; number the frames of every session"
    )]
    NoFrame {
        /// The edge.
        edge: String,
        /// The node.
        node: u64,
    },
}

/// A landmark edge by the frames it joins.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Match {
    /// The two sessions, by their indices in the graph's order of sessions; the earlier first.
    pub sessions: (usize, usize),
    /// The frame of the later session, or the later frame within one: the query of place recognition.
    pub query: i64,
    /// The frame that it was matched to.
    pub matched: i64,
    /// The edge's index among the graph's edges.
    pub edge: usize,
}

/// The landmark edges in use, in the order of the graph. O(edges).
pub fn matches(graph: &PoseGraph) -> Result<Vec<Match>, FrameError> {
    let sessions = graph.sessions();
    let place = |edge: &Edge, id: u64| {
        graph
            .node_index(id)
            .map(|index| &graph.nodes[index])
            .and_then(|node| {
                let (name, frame) = node.session_frame()?;
                Some((sessions.iter().position(|&session| session == name)?, frame))
            })
            .ok_or_else(|| FrameError::NoFrame { edge: edge.name(), node: id })
    };
    graph
        .edges
        .iter()
        .enumerate()
        .filter(|(_, edge)| edge.kind == EdgeKind::Landmark && edge.in_use())
        .map(|(index, edge)| {
            let (from, to) = (place(edge, edge.from)?, place(edge, edge.to)?);
            let (early, late) = if from <= to { (from, to) } else { (to, from) };
            Ok(Match { sessions: (early.0, late.0), query: late.1, matched: early.1, edge: index })
        })
        .collect()
}

/// Clusters of matches. Two matches of the same sessions belong together if both their frames are at most `gap` apart, or
/// if a chain of such matches joins them. Each cluster lists indices in `matches`, ascending; clusters come in the order of
/// their first match.
///
/// Matches are sorted by query, so that each is compared only with those of the last `gap` queries: O(n log n + pairs
/// within the gap).
pub fn clusters(matches: &[Match], gap: u64) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..matches.len()).collect();
    order.sort_by_key(|&place| &matches[place]);
    let mut parts = UnionFind::<usize>::new(matches.len());
    for (rank, &late) in order.iter().enumerate() {
        for &early in order[..rank].iter().rev() {
            let (one, other) = (&matches[early], &matches[late]);
            if one.sessions != other.sessions || one.query.abs_diff(other.query) > gap {
                break;
            }
            if one.matched.abs_diff(other.matched) <= gap {
                parts.union(early, late);
            }
        }
    }
    let mut clusters: Vec<Vec<usize>> = Vec::new();
    let mut numbers = HashMap::new();
    for place in 0..matches.len() {
        let number = *numbers.entry(parts.find(place)).or_insert(clusters.len());
        if number == clusters.len() {
            clusters.push(Vec::new());
        }
        clusters[number].push(place);
    }
    clusters
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(session: usize, query: i64, matched: i64) -> Match {
        Match { sessions: (0, session), query, matched, edge: 0 }
    }

    /// Clusters by trying all pairs until nothing changes.
    fn by_flooding(matches: &[Match], gap: u64) -> Vec<usize> {
        let mut labels: Vec<usize> = (0..matches.len()).collect();
        loop {
            let before = labels.clone();
            for a in 0..matches.len() {
                for b in 0..matches.len() {
                    let near = matches[a].sessions == matches[b].sessions
                        && matches[a].query.abs_diff(matches[b].query) <= gap
                        && matches[a].matched.abs_diff(matches[b].matched) <= gap;
                    if near {
                        labels[a] = labels[a].min(labels[b]);
                    }
                }
            }
            if labels == before {
                return labels;
            }
        }
    }

    proptest! {
        #[test]
        fn clusters_are_the_connected_components_of_near_matches(
            points in proptest::collection::vec((0_usize..2, -20_i64..20, -20_i64..20), 0..40),
            gap in 0_u64..5,
        ) {
            let matches: Vec<Match> = points.iter().map(|&(s, q, m)| point(s, q, m)).collect();
            let mut labels = vec![usize::MAX; matches.len()];
            for cluster in clusters(&matches, gap) {
                prop_assert!(cluster.is_sorted());
                for &member in &cluster {
                    labels[member] = cluster[0];
                }
            }
            prop_assert_eq!(labels, by_flooding(&matches, gap));
        }
    }

    #[test]
    fn frames_at_the_ends_of_the_numbers_do_not_overflow() {
        let matches = [point(0, i64::MIN, i64::MAX), point(0, i64::MAX, i64::MIN)];
        assert_eq!(clusters(&matches, 1).len(), 2);
        assert_eq!(clusters(&matches, u64::MAX).len(), 1);
    }
}

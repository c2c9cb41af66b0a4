//! Support of landmark edges compared with its definition.
use std::collections::BTreeSet;

use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, PoseGraph};
use posecut_multicut::support::support_counts;
use proptest::prelude::*;

const FRAMES: u64 = 7;

/// Two sessions of seven frames. Edges are given by nodes, in either direction, also within a session.
fn pose_graph(edges: &[(u64, u64, bool)]) -> PoseGraph {
    let mut graph = PoseGraph::new(Header::new(Dimension::Two));
    for id in 0..2 * FRAMES {
        let session = if id < FRAMES { "a" } else { "b" };
        let frame = Some((id % FRAMES) as i64 - 3);
        graph.nodes.push(Node { id, session: Some(session.into()), frame, ..Node::default() });
    }
    for (id, &(from, to, in_use)) in (100..).zip(edges) {
        let mut edge = Edge::new(EdgeKind::Landmark, id, from, to);
        if !in_use {
            edge.reject("pcm");
        }
        graph.edges.push(edge);
    }
    graph
}

/// Counts by the definition: every other pair of frames, in either direction.
fn by_definition(edges: &[(u64, u64, bool)], delta: u32) -> Vec<(usize, usize)> {
    let used = || edges.iter().enumerate().filter(|(_, edge)| edge.2);
    let pair = |edge: &(u64, u64, bool)| (edge.0.min(edge.1), edge.0.max(edge.1));
    let near = |u: u64, v: u64| u / FRAMES == v / FRAMES && u.abs_diff(v) <= u64::from(delta);
    let pairs: BTreeSet<(u64, u64)> = used().map(|(_, edge)| pair(edge)).collect();
    used()
        .map(|(index, edge)| {
            let (i, j) = pair(edge);
            let supports = |&&(p, q): &&(u64, u64)| {
                (p, q) != (i, j) && ((near(i, p) && near(j, q)) || (near(i, q) && near(j, p)))
            };
            (index, pairs.iter().filter(supports).count())
        })
        .collect()
}

proptest! {
    // If there are more pairs than the (2 delta + 1)^2 positions of a window, each position is looked up; otherwise the pairs
    // are searched. 0 to 60 edges and delta 0 to 4 test both ways.
    #[test]
    fn support_is_what_its_definition_says(
        edges in prop::collection::vec((0..2 * FRAMES, 0..2 * FRAMES, prop::bool::weighted(0.9)), 0..60),
        delta in 0u32..=4,
    ) {
        let edges: Vec<_> = edges.into_iter().filter(|edge| edge.0 != edge.1).collect();
        prop_assert_eq!(support_counts(&pose_graph(&edges), delta).unwrap(), by_definition(&edges, delta));
    }
}

#[test]
fn directions_and_duplicates_do_not_count_twice() {
    // 0-7 occurs three times, once backwards; the only other pair is 1-8.
    let edges = [(0, 7, true), (7, 0, true), (0, 7, true), (8, 1, true)];
    let counts = support_counts(&pose_graph(&edges), 1).unwrap();
    assert_eq!(counts, [(0, 1), (1, 1), (2, 1), (3, 1)]);
}

#[test]
fn a_full_window_has_no_more_than_the_largest_count() {
    let edges: Vec<_> = (0..FRAMES).flat_map(|i| (0..FRAMES).map(move |j| (i, FRAMES + j, true))).collect();
    for delta in 0..=3 {
        let largest = support_counts(&pose_graph(&edges), delta).unwrap().iter().map(|count| count.1).max();
        assert_eq!(largest, Some(4 * (delta * (delta + 1)) as usize));
    }
    let all = support_counts(&pose_graph(&edges), u32::MAX).unwrap();
    assert!(all.iter().all(|count| count.1 == edges.len() - 1));
}

#[test]
fn a_node_without_a_frame_is_named() {
    let mut graph = pose_graph(&[(0, 7, true)]);
    graph.nodes[7].frame = None;
    let error = support_counts(&graph, 1).unwrap_err().to_string();
    assert!(
        error.contains("landmark 100") && error.contains("node 7") && error.contains("--costs field"),
        "{error}"
    );
}

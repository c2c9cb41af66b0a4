//! Findings about the spacing of candidates.

use posecut_doctor::Severity;
use posecut_graph::{EdgeKind, PoseGraph};

use crate::drives::{plane, split};
use crate::{absent, found};

/// The drive with a landmark edge at every `n`-th node only.
fn every(n: u64) -> PoseGraph {
    let mut graph = plane();
    graph.edges.retain(|edge| edge.kind == EdgeKind::Odometry || edge.from % n == 0);
    graph
}

#[test]
fn a_candidate_at_every_fifth_frame_asks_for_another_delta() {
    let finding = found(&every(5), "spacing", Severity::Warning);
    assert_eq!(finding.numbers["delta_auto"], serde_json::json!([5, 5]));
    assert_eq!(
        (&finding.numbers["without_support_at_1"], &finding.numbers["without_support_at_auto"]),
        (&24.into(), &0.into())
    );
    assert!(finding.title.contains("5 frames apart (median), 24 (100 %)"), "{finding:?}");
    assert!(finding.remedy.contains("--delta auto (here 5)"), "{finding:?}");
}

#[test]
fn the_table_has_median_and_delta_of_each_pair_of_sessions() {
    let finding = found(&split(every(3)), "spacing", Severity::Warning);
    let expected = serde_json::json!([{"sessions": ["a", "b"], "candidates": 40, "median": 3.0, "delta": 3}]);
    assert_eq!(finding.numbers["pairs"], expected);
    let dense = found(&plane(), "spacing", Severity::Note);
    assert_eq!(dense.numbers["pairs"][0]["delta"], 1);
    assert!(dense.title.contains("1 frame apart"), "{dense:?}");
}

/// Without a spacing that helps, the spacing is not to blame.
#[test]
fn scattered_candidates_are_noted() {
    let mut graph = plane();
    graph.edges.retain(|edge| edge.kind == EdgeKind::Odometry || [3, 40, 44, 90, 99].contains(&edge.from));
    found(&graph, "spacing", Severity::Note);
}

#[test]
fn nodes_without_frames_are_noted() {
    let mut graph = plane();
    absent(&graph, "no-frames");
    for node in &mut graph.nodes {
        node.frame = None;
    }
    assert_eq!(found(&graph, "no-frames", Severity::Note).numbers["nodes"], 240);
}

//! Findings about gaps and times.

use posecut_doctor::Severity;
use posecut_graph::EdgeKind;

use crate::drives::{plane, split};
use crate::{absent, found};

#[test]
fn missing_odometry_is_counted_with_its_first_place() {
    let mut graph = plane();
    absent(&graph, "odometry-gaps");
    graph.edges.retain(|edge| edge.kind == EdgeKind::Landmark || (edge.from != 17 && edge.from != 99));
    let finding = found(&graph, "odometry-gaps", Severity::Warning);
    assert_eq!((&finding.numbers["gaps"], &finding.numbers["pieces"]), (&2.into(), &3.into()));
    assert_eq!(finding.numbers["first"], serde_json::json!([17, 18]));
    assert!(finding.remedy.starts_with("add the missing odometry"), "{finding:?}");
}

/// The nodes of two sessions are not consecutive.
#[test]
fn between_sessions_there_is_no_gap() {
    absent(&split(plane()), "odometry-gaps");
}

#[test]
fn odometry_written_as_landmark_edges_is_recognised_in_gaps() {
    let mut graph = plane();
    for edge in graph.edges.iter_mut().take(10) {
        edge.kind = EdgeKind::Landmark;
    }
    let finding = found(&graph, "odometry-gaps", Severity::Warning);
    assert!(finding.remedy.starts_with("10 of these pairs are joined by landmark edges"), "{finding:?}");
}

#[test]
fn odometry_that_rarely_joins_neighbours_asks_for_an_order() {
    let mut graph = plane();
    for (index, node) in graph.nodes.iter_mut().enumerate() {
        node.frame = Some((index as i64 * 7) % 240);
    }
    let finding = found(&graph, "odometry-gaps", Severity::Warning);
    assert!(finding.remedy.starts_with("number the nodes"), "{finding:?}");
}

#[test]
fn times_that_decrease_are_reported() {
    let mut graph = plane();
    absent(&graph, "times-decrease");
    graph.nodes[50].utime = graph.nodes[10].utime.map(|time| time + 1);
    let finding = found(&graph, "times-decrease", Severity::Warning);
    assert_eq!(finding.numbers["first"], serde_json::json!([49, 50]));
}

#[test]
fn pauses_are_noted() {
    let mut graph = plane();
    absent(&graph, "time-jumps");
    for node in &mut graph.nodes[80..] {
        node.utime = node.utime.map(|time| time + 300_000_000);
    }
    let finding = found(&graph, "time-jumps", Severity::Note);
    assert!(finding.title.contains("302 s instead of 2 s from node 79"), "{finding:?}");
}

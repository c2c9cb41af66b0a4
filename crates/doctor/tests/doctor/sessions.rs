//! Findings about sessions and components.

use posecut_doctor::Severity;
use posecut_graph::EdgeKind;

use crate::drives::{edges_of, plane, split};
use crate::{absent, found};

#[test]
fn overlaps_are_listed() {
    let finding = found(&split(plane()), "sessions", Severity::Note);
    let expected = serde_json::json!([{"sessions": ["a", "b"], "landmark_edges": 120}]);
    assert_eq!(finding.numbers["overlaps"], expected);
    assert_eq!(finding.numbers["components"], 1);
    assert_eq!(finding.numbers["components_without_landmark_edges"], 2);
    assert!(finding.title.contains("2 by odometry alone"), "{finding:?}");
    let single = found(&plane(), "sessions", Severity::Note);
    assert_eq!(single.title, "1 session, 120 landmark edges; 1 component");
}

#[test]
fn sessions_that_nothing_joins_are_named() {
    let mut graph = split(plane());
    absent(&graph, "components");
    absent(&graph, "sessions-without-overlap");
    graph.edges.retain(|edge| edge.kind == EdgeKind::Odometry);
    let finding = found(&graph, "components", Severity::Warning);
    assert_eq!(finding.numbers["nodes"], serde_json::json!([120, 120]));
    let finding = found(&graph, "sessions-without-overlap", Severity::Warning);
    assert_eq!(finding.numbers["sessions"], serde_json::json!(["a", "b"]));
}

#[test]
fn a_graph_without_landmark_edges_has_nothing_to_judge() {
    let mut graph = plane();
    absent(&graph, "no-landmark-edges");
    graph.edges.retain(|edge| edge.kind == EdgeKind::Odometry);
    found(&graph, "no-landmark-edges", Severity::Warning);
}

#[test]
fn rejected_edges_are_counted_by_stage_and_nowhere_else() {
    let mut graph = plane();
    absent(&graph, "rejected-edges");
    for edge in edges_of(&mut graph, EdgeKind::Landmark).take(30) {
        edge.reject("pcm");
    }
    let finding = found(&graph, "rejected-edges", Severity::Note);
    assert_eq!(finding.numbers["by"], serde_json::json!({"pcm": 30}));
    assert_eq!(found(&graph, "spacing", Severity::Note).numbers["candidates"], 90);
}

/// Edges that do not agree on where session b lies.
#[test]
fn joins_without_agreement_are_reported() {
    let mut graph = split(plane());
    absent(&graph, "unproved-joins");
    for (index, edge) in edges_of(&mut graph, EdgeKind::Landmark).enumerate() {
        let angle = 2.4 * index as f64;
        edge.measurement =
            Some(vec![9.0 * angle.sin() + index as f64, 30.0 * (0.7 * angle).cos(), angle % 3.1]);
    }
    let finding = found(&graph, "unproved-joins", Severity::Warning);
    assert_eq!((&finding.numbers["open"], &finding.numbers["proposed"]), (&1.into(), &1.into()));
}

#[test]
fn an_empty_graph_is_an_error() {
    let mut graph = plane();
    (graph.nodes, graph.edges) = (Vec::new(), Vec::new());
    let findings = posecut_doctor::examine(&graph);
    assert_eq!(findings.iter().map(|finding| finding.name).collect::<Vec<_>>(), ["empty"]);
    assert_eq!(findings[0].severity, Severity::Error);
}

#[test]
fn doubts_of_earlier_stages_are_noted() {
    let mut graph = plane();
    absent(&graph, "doubts");
    graph.header.provenance.push(serde_json::json!({"stage": "ingest", "doubts": ["covariance-invented"]}));
    let finding = found(&graph, "doubts", Severity::Note);
    assert!(finding.title.ends_with("covariance-invented by ingest"), "{finding:?}");
}

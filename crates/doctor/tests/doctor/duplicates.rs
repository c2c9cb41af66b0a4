//! Findings about nodes and edges that occur twice.

use posecut_doctor::Severity;
use posecut_graph::{Edge, EdgeKind, PoseGraph};

use crate::drives::{motion, plane};
use crate::{absent, found};

/// Adds a copy of an edge with another id.
fn copied(graph: &mut PoseGraph, index: usize) -> &mut Edge {
    let copy = Edge { id: 1000 + index as u64, ..graph.edges[index].clone() };
    graph.edges.push(copy);
    graph.edges.last_mut().unwrap()
}

#[test]
fn a_copy_of_a_landmark_edge_is_reported_and_a_second_measurement_is_noted() {
    let mut graph = plane();
    absent(&graph, "repeated-landmark-edges");
    copied(&mut graph, 300).measurement.as_mut().unwrap()[0] += 0.1;
    let finding = found(&graph, "repeated-landmark-edges", Severity::Note);
    assert_eq!(finding.numbers["first"], serde_json::json!([300 + 1, 1300]));
    copied(&mut graph, 301);
    let finding = found(&graph, "repeated-landmark-edges", Severity::Warning);
    assert_eq!((&finding.numbers["edges"], &finding.numbers["copies"]), (&2.into(), &1.into()));
    let mut many = plane();
    for index in 300..310 {
        copied(&mut many, index).measurement.as_mut().unwrap()[0] += 0.1;
    }
    found(&many, "repeated-landmark-edges", Severity::Warning);
}

/// An edge back is the same pair.
#[test]
fn direction_does_not_matter() {
    let mut graph = plane();
    let edge = copied(&mut graph, 300);
    (edge.from, edge.to) = (edge.to, edge.from);
    let back = posecut_geometry::LieGroup::inverse(&motion(edge));
    edge.measurement = Some(posecut_geometry::LieGroup::components(&back));
    found(&graph, "repeated-landmark-edges", Severity::Note);
}

#[test]
fn two_odometry_edges_of_one_step_are_reported() {
    let mut graph = plane();
    absent(&graph, "repeated-odometry-edges");
    copied(&mut graph, 5);
    assert_eq!(found(&graph, "repeated-odometry-edges", Severity::Warning).numbers["pairs"], 1);
}

#[test]
fn landmark_edges_beside_odometry_are_noted() {
    let mut graph = plane();
    absent(&graph, "landmark-beside-odometry");
    copied(&mut graph, 5).kind = EdgeKind::Landmark;
    assert_eq!(found(&graph, "landmark-beside-odometry", Severity::Note).numbers["edges"], 1);
}

#[test]
fn repeated_frames_and_times_are_reported() {
    let mut graph = plane();
    absent(&graph, "repeated-frames");
    absent(&graph, "repeated-times");
    graph.nodes[20].frame = graph.nodes[19].frame;
    graph.nodes[30].utime = graph.nodes[29].utime;
    assert_eq!(
        found(&graph, "repeated-frames", Severity::Warning).numbers["first"],
        serde_json::json!([19, 20])
    );
    assert_eq!(
        found(&graph, "repeated-times", Severity::Warning).numbers["first"],
        serde_json::json!([29, 30])
    );
    // Frames of two sessions may be equal.
    graph.nodes[20].session = Some("other".to_owned());
    absent(&graph, "repeated-frames");
}

//! Findings about which edges are odometry.

use posecut_doctor::Severity;
use posecut_graph::{Edge, EdgeKind};

use crate::drives::{LAP, edges_of, plane, split};
use crate::{absent, found};

#[test]
fn odometry_that_became_landmark_edges_is_an_error_with_the_command_that_helps() {
    let mut graph = plane();
    for node in &mut graph.nodes {
        node.id *= 10;
    }
    for edge in &mut graph.edges {
        (edge.kind, edge.from, edge.to) = (EdgeKind::Landmark, edge.from * 10, edge.to * 10);
    }
    let finding = found(&graph, "no-odometry", Severity::Error);
    assert!(finding.title.contains("239 of 239 pairs") && finding.title.contains("ids count by 10"));
    assert!(finding.remedy.contains("posecut convert --odometry next-id"), "{finding:?}");
    absent(&plane(), "no-odometry");
}

#[test]
fn landmark_edges_without_any_odometry_ask_for_odometry() {
    let mut graph = plane();
    graph.edges.retain(|edge| edge.kind == EdgeKind::Landmark);
    let finding = found(&graph, "no-odometry", Severity::Error);
    assert!(finding.remedy.starts_with("add odometry edges"), "{finding:?}");
}

#[test]
fn a_trajectory_is_no_graph() {
    let mut graph = plane();
    graph.edges.clear();
    let finding = found(&graph, "no-odometry", Severity::Error);
    assert!(finding.title.contains("240 nodes and no edges"), "{finding:?}");
}

#[test]
fn ids_that_count_by_ten_are_noted() {
    let mut graph = plane();
    for node in &mut graph.nodes {
        node.id *= 10;
    }
    for edge in &mut graph.edges {
        (edge.from, edge.to) = (edge.from * 10, edge.to * 10);
    }
    let finding = found(&graph, "odometry", Severity::Note);
    assert_eq!(finding.numbers["stride"], 10);
    assert!(found(&plane(), "odometry", Severity::Note).numbers["stride"].is_null());
}

#[test]
fn a_session_without_odometry_is_named() {
    let mut graph = split(plane());
    absent(&graph, "sessions-without-odometry");
    graph.edges.retain(|edge| edge.kind == EdgeKind::Landmark || edge.from < LAP as u64);
    let finding = found(&graph, "sessions-without-odometry", Severity::Warning);
    assert!(finding.title.ends_with(": b"), "{finding:?}");
}

#[test]
fn odometry_between_sessions_is_reported() {
    let mut graph = split(plane());
    absent(&graph, "odometry-between-sessions");
    graph.edges[240].kind = EdgeKind::Odometry;
    let id = graph.edges[240].id;
    assert_eq!(found(&graph, "odometry-between-sessions", Severity::Warning).numbers["first"], id);
}

#[test]
fn odometry_that_skips_nodes_branches_off() {
    let mut graph = plane();
    absent(&graph, "odometry-branches");
    let mut skip = Edge::new(EdgeKind::Odometry, 1000, 0, 2);
    skip.measurement = Some(vec![4.0, 0.0, 0.1]);
    skip.information.clone_from(&graph.edges[0].information);
    graph.edges.push(skip);
    assert_eq!(found(&graph, "odometry-branches", Severity::Warning).numbers["edges"], 1);
}

#[test]
fn rejected_odometry_is_reported() {
    let mut graph = plane();
    absent(&graph, "odometry-rejected");
    edges_of(&mut graph, EdgeKind::Odometry).nth(7).unwrap().reject("verify");
    assert_eq!(found(&graph, "odometry-rejected", Severity::Warning).numbers["edges"], 1);
}

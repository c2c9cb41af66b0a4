//! Reads several g2o files, such as one a robot, into one graph.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_convert::g2o::{ReadOptions, read_several};
use posecut_graph::{EdgeKind, PoseGraph};

/// Robots a and b: gtsam keeps the letter in the top byte of an id.
const A: u64 = 97 << 56;
const B: u64 = 98 << 56;

fn read(files: &[String]) -> Result<PoseGraph, String> {
    let files = files.iter().enumerate().map(|(at, text)| (format!("{at}.g2o"), text.as_bytes())).collect();
    read_several(files, &ReadOptions::default()).map(|(graph, _)| graph).map_err(|error| error.to_string())
}

fn robot(key: u64, shared: &str) -> String {
    let next = key + 1;
    format!(
        "VERTEX_SE2 {key} 0 0 0\nVERTEX_SE2 {next} 1 0 0\nEDGE_SE2 {key} {next} 1 0 0 1 0 0 1 0 1\n{shared}"
    )
}

fn closure(x: f64) -> String {
    format!("EDGE_SE2 {A} {B} {x} 2 0 1 0 0 1 0 1\n")
}

#[test]
fn robots_become_sessions_and_their_common_edges_are_read_once() {
    let graph = read(&[robot(A, &closure(3.0)), robot(B, &closure(3.0))]).unwrap();
    assert_eq!(graph.sessions(), ["a", "b"]);
    assert_eq!(graph.nodes.len(), 4);
    assert_eq!(graph.edges_of(EdgeKind::Odometry).count(), 2);
    assert_eq!(graph.edges_of(EdgeKind::Landmark).count(), 1);
    // An edge with other numbers is another edge. The same edge twice in one file counts as two.
    let graph = read(&[robot(A, &closure(3.0)), robot(B, &closure(4.0))]).unwrap();
    assert_eq!(graph.edges_of(EdgeKind::Landmark).count(), 2);
    let graph = read(&[robot(A, &closure(3.0).repeat(2)), robot(B, "")]).unwrap();
    assert_eq!(graph.edges_of(EdgeKind::Landmark).count(), 2);
}

#[test]
fn a_vertex_with_other_numbers_in_another_file_is_refused_with_its_file_and_line() {
    let again = read(&[robot(A, ""), format!("VERTEX_SE2 {A} 0 0 0\n")]).unwrap();
    assert_eq!(again.nodes.len(), 2);
    let said = read(&[robot(A, ""), format!("VERTEX_SE2 {A} 0 0 1\n")]).unwrap_err();
    assert!(said.starts_with("1.g2o, line 1: ") && said.contains("occurs twice"), "{said}");
    let said = read(&[robot(A, "").repeat(2)]).unwrap_err();
    assert!(said.starts_with("0.g2o, line 4: "), "{said}");
}

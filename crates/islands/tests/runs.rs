//! Runs of landmark edges through the program.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::io::Write as _;
use std::process::{Command, Stdio};

use posecut_graph::PoseGraph;

/// Two sessions of 30 frames, and landmark edges between frames of the first and of the second.
fn graph(landmarks: &[(u64, u64)]) -> String {
    let mut text = "{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n".to_owned();
    for id in 0..60 {
        let (session, frame) = if id < 30 { ("a", id) } else { ("b", id - 30) };
        text += &format!("{{\"kind\":\"node\",\"id\":{id},\"session\":\"{session}\",\"frame\":{frame}}}\n");
    }
    for (id, (first, second)) in landmarks.iter().enumerate() {
        // Every other edge is stored in reverse.
        let (from, to) = if id % 2 == 0 { (*first, 30 + second) } else { (30 + second, *first) };
        text += &format!("{{\"kind\":\"landmark\",\"id\":{id},\"from\":{from},\"to\":{to}}}\n");
    }
    text
}

fn rejected(input: &str, arguments: &[&str]) -> Vec<u64> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_posecut-islands"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success());
    let graph = PoseGraph::read("test", output.stdout.as_slice()).unwrap();
    graph.edges.iter().filter(|edge| !edge.in_use()).map(|edge| edge.id).collect()
}

#[test]
fn runs_stay_whichever_way_they_are_stored_and_lone_edges_go() {
    // A run forwards, a run backwards, a lone edge, and a pair.
    let text = graph(&[(1, 1), (2, 2), (3, 3), (10, 20), (11, 19), (12, 18), (25, 5), (5, 28), (6, 29)]);
    assert_eq!(rejected(&text, &[]), [6, 7, 8]);
    assert_eq!(rejected(&text, &["--minimum-frames", "2"]), [6]);
    assert_eq!(rejected(&text, &["--minimum-frames", "1"]), Vec::<u64>::new());
}

#[test]
fn a_gap_may_be_crossed_if_it_is_allowed() {
    let text = graph(&[(1, 1), (4, 4), (7, 7)]);
    assert_eq!(rejected(&text, &[]), [0, 1, 2]);
    assert_eq!(rejected(&text, &["--gap", "3"]), Vec::<u64>::new());
}

#[test]
fn many_matches_of_one_query_are_one_frame() {
    // Place recognition asked once, and got three neighbours: that is no confirmation over time.
    let text = graph(&[(1, 9), (2, 9), (3, 9)]);
    assert_eq!(rejected(&text, &[]), [0, 1, 2]);
}

#[test]
fn scores_can_be_asked_for() {
    let text = graph(&[(1, 1), (2, 2), (3, 3)]).replace("\"to\":", "\"score\":0.25,\"to\":");
    assert_eq!(rejected(&text, &["--minimum-score", "0.75"]), Vec::<u64>::new());
    assert_eq!(rejected(&text, &["--minimum-score", "0.76"]), [0, 1, 2]);
}

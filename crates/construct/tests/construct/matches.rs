//! Tests that lists of matches become candidate edges, or are refused with an error that names their line.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_construct::{Landmarks, MatchMeasurement, Options, construct, read_matches};
use posecut_graph::{EdgeKind, PoseGraph};

use crate::rounds::{options, rounds};

fn build(list: &str, names: &[&str], options: &Options) -> Result<PoseGraph, String> {
    let matches = read_matches("list.csv", list.as_bytes()).map_err(|error| error.to_string())?;
    let landmarks = Landmarks::Matches { file: "list.csv".to_owned(), matches };
    let graphs = names.iter().map(|name| rounds(name, 200)).collect();
    construct(graphs, &landmarks, options)
        .map(|construction| construction.graph)
        .map_err(|error| error.to_string())
}

#[test]
fn matches_become_edges_with_scores_and_the_judgement_of_the_truth() {
    let graph = build("# best first\n10,168,0.9\n100,20,0.2\n", &["s"], &options()).unwrap();
    let edges: Vec<_> = graph.edges_of(EdgeKind::Landmark).collect();
    let seen: Vec<_> =
        edges.iter().map(|edge| (edge.from, edge.to, edge.score, edge.truth_correct())).collect();
    assert_eq!(seen, [(10, 168, Some(0.9), Some(true)), (20, 100, Some(0.2), Some(false))]);
    assert!(edges.iter().all(|edge| edge.measurement.is_none() && edge.noise.is_none()));
}

#[test]
fn identity_gives_the_edges_a_measurement() {
    let asked = Options { match_measurement: MatchMeasurement::Identity, ..options() };
    let graph = build("10,168", &["s"], &asked).unwrap();
    let edge = graph.edges_of(EdgeKind::Landmark).next().unwrap();
    assert_eq!(edge.measurement.as_deref(), Some(&[0.0, 0.0, 0.0][..]));
    assert!((graph.information(edge).unwrap()[0] - 100.0).abs() < 1e-9, "1 / 0.1^2");
    let mut bytes = Vec::new();
    graph.write(&mut bytes).unwrap();
    assert_eq!(PoseGraph::read("again", &bytes[..]).unwrap(), graph);
}

#[test]
fn columns_are_found_by_name() {
    let list = "score,frame_j,frame_i,session_i,session_j\n0.5,3,4,t,s\n0.6,7,8,t,t\n";
    let graph = build(list, &["s", "t"], &options()).unwrap();
    let ends: Vec<_> = graph.edges_of(EdgeKind::Landmark).map(|edge| (edge.from, edge.to)).collect();
    assert_eq!(ends, [(3, 204), (207, 208)]);
}

#[test]
fn of_two_sessions_i_is_of_the_first_and_j_of_the_second() {
    let graph = build("5,6", &["s", "t"], &options()).unwrap();
    let edge = graph.edges_of(EdgeKind::Landmark).next().unwrap();
    assert_eq!((edge.from, edge.to), (5, 206));
}

#[test]
fn an_empty_list_is_a_graph_without_landmark_edges() {
    assert_eq!(build("", &["s"], &options()).unwrap().edges_of(EdgeKind::Landmark).count(), 0);
}

#[test]
fn lines_that_cannot_be_used_are_named() {
    let cases: &[(&str, &[&str], &str)] = &[
        ("1,x", &["s"], "list.csv:1: frame_j is \"x\", but must be a whole number; correct the line"),
        ("1,2\n7", &["s"], "list.csv:2: frame_j is \"\", but must be a whole number; correct the line"),
        ("1,2,NaN", &["s"], "list.csv:1: score is \"NaN\", but must be a finite number; correct the line"),
        (
            "1,2\n2,1",
            &["s"],
            "list.csv:2: the same two frames are already matched on line 1; delete one of the two lines",
        ),
        ("3,3", &["s"], "list.csv:1: frame 3 is matched to itself; delete the line"),
        (
            "1,999",
            &["s"],
            "list.csv:1: no node has frame 999; use the frame numbers of the session graphs, after down-sampling",
        ),
        (
            "1,2",
            &["s", "t", "u"],
            "list.csv:1: frame 1 is in several sessions; add the columns session_i and session_j",
        ),
        (
            "frame_i,frame_j,session_i\n1,2,x",
            &["s", "t"],
            "list.csv:2: there is no session \"x\"; use one of s, t",
        ),
        (
            "from,to\n1,2",
            &["s"],
            "list.csv:1: the header has no column \"frame_i\"; name the columns frame_i,frame_j,score (and session_i,session_j), or remove the header",
        ),
    ];
    for (list, names, expected) in cases {
        assert_eq!(build(list, names, &options()).unwrap_err(), *expected);
    }
    let error = read_matches("list.csv", b"1,2\n\xff,3").unwrap_err().to_string();
    assert!(error.starts_with("list.csv:2: "), "{error}");
}

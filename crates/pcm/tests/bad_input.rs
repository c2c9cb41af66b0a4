//! Graphs that are hardly graphs, through the stage's library: what happens is defined, and nothing panics.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_geometry::SE2;
use posecut_graph::PoseGraph;
use posecut_pcm::candidate::group;
use posecut_pcm::chain::{Chains, Covariances};
use posecut_pcm::consistency::Pairs;
use posecut_pcm::readmission::{Readmission, readmit};
use posecut_pcm::{Gate, PcmError, Test};

const HEADER: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#;

fn graph(lines: &[&str]) -> PoseGraph {
    PoseGraph::read("test", format!("{HEADER}\n{}\n", lines.join("\n")).as_bytes()).unwrap()
}

fn nodes(count: usize) -> Vec<String> {
    (0..count).map(|id| format!(r#"{{"kind":"node","id":{id},"pose":[{id},0,0]}}"#)).collect()
}

fn edge(kind: &str, id: u64, from: u64, to: u64, information: &str) -> String {
    format!(
        r#"{{"kind":"{kind}","id":{id},"from":{from},"to":{to},"measurement":[{},0,0],"information":{information}}}"#,
        to as i64 - from as i64
    )
}

const GOOD: &str = "[100,0,0,100,0,400]";

fn with(mut lines: Vec<String>, more: &[String]) -> PoseGraph {
    lines.extend_from_slice(more);
    graph(&lines.iter().map(String::as_str).collect::<Vec<_>>())
}

#[test]
fn a_candidate_into_a_gap_of_the_odometry_joins_the_pieces_it_touches() {
    // 0-1-2, a gap, 3-4-5; node 6 has no odometry at all.
    let odometry: Vec<String> = [(0, 1), (1, 2), (3, 4), (4, 5)]
        .iter()
        .enumerate()
        .map(|(id, &(from, to))| edge("odometry", id as u64, from, to, GOOD))
        .collect();
    let landmarks = [
        edge("landmark", 10, 0, 3, GOOD),
        edge("landmark", 11, 2, 5, GOOD),
        edge("landmark", 12, 1, 6, GOOD),
    ];
    let graph = with(nodes(7), &[&odometry[..], &landmarks[..]].concat());
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let found: Vec<(usize, usize, usize)> =
        grouped.groups.iter().map(|group| (group.a, group.b, group.candidates.len())).collect();
    assert_eq!(found, [(0, 1, 2), (0, 2, 1)]);
    let (matrix, _) =
        Pairs::new(&chains, &grouped.groups[0]).graph(Gate::new(Test::Mahalanobis, 0.99, 3).unwrap());
    assert!(matrix.connected(0, 1), "both claim the same across the gap");
}

#[test]
fn singular_and_indefinite_information_of_a_landmark_edge_is_refused_with_the_edge() {
    for information in ["[100,0,0,100,0,0]", "[0,0,0,0,0,0]", "[1,1,0,1,0,1]"] {
        let graph = with(nodes(2), &[edge("landmark", 7, 0, 1, information)]);
        let chains = Chains::<SE2, 3>::of(&graph).unwrap();
        let error = group(&graph, &chains).unwrap_err();
        assert!(matches!(&error, PcmError::Covariance { edge, .. } if edge == "landmark 7"), "{error}");
        // The test that reads no covariances takes the graph.
        let chains = Chains::<SE2, 3>::with(&graph, Covariances::Ignored).unwrap();
        assert!(posecut_pcm::candidate::group_with(&graph, &chains, Covariances::Ignored).is_ok());
    }
    let indefinite =
        format!("{HEADER}\n{}\n{}\n", nodes(2).join("\n"), edge("landmark", 7, 0, 1, "[1,2,0,1,0,1]"));
    let error = PoseGraph::read("test", indefinite.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("landmark") || error.contains("information"), "{error}");
}

#[test]
fn a_session_of_one_node_can_have_candidates() {
    let odometry = [edge("odometry", 0, 0, 1, GOOD)];
    let landmarks = [edge("landmark", 5, 0, 2, GOOD), edge("landmark", 6, 1, 2, GOOD)];
    let graph = with(nodes(3), &[&odometry[..], &landmarks[..]].concat());
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    let grouped = group(&graph, &chains).unwrap();
    let (matrix, counts) =
        Pairs::new(&chains, &grouped.groups[0]).graph(Gate::new(Test::Mahalanobis, 0.99, 3).unwrap());
    assert_eq!((matrix.edges(), counts.pairs, counts.indefinite), (1, 1, 0));
}

#[test]
fn a_candidate_from_a_node_to_itself_is_a_candidate_of_its_chain() {
    let odometry = [edge("odometry", 0, 0, 1, GOOD)];
    let graph = with(nodes(2), &[&odometry[..], &[edge("landmark", 5, 0, 1, GOOD)]].concat());
    let chains = Chains::<SE2, 3>::of(&graph).unwrap();
    assert_eq!(group(&graph, &chains).unwrap().groups.len(), 1);
}

const READMISSION: Readmission =
    Readmission { admit: 0.99, drop: 0.9999, scale: Some(1.0), apply_scale: false, cost: 3.0 };

fn predicted(edge: &str, terms: &str) -> String {
    edge.replace('}', &format!(r#","predicted_covariance":{terms}}}"#))
}

#[test]
fn readmission_admits_drops_and_keeps_by_the_innovation() {
    // sigma^2 = 0.01 m^2 and 0.0025 rad^2; the estimate says that node n is at n metres.
    let near = predicted(&edge("landmark", 1, 0, 2, GOOD), "[0.005,0,0,0.005,0,0.001]")
        .replace("[2,0,0]", "[2.1,0,0]");
    let wrong = predicted(&edge("landmark", 2, 0, 3, GOOD), "[0.005,0,0,0.005,0,0.001]")
        .replace("[3,0,0]", "[5,0,0]");
    let rejected = |line: &str, stage: &str| line.replace('}', &format!(r#","rejected_by":"{stage}"}}"#));
    let lone = predicted(&edge("landmark", 3, 3, 4, GOOD), "[0.01,0,0,0.01,0,0.0025]");
    let unpredicted = predicted(&edge("landmark", 4, 1, 4, GOOD), "null");
    let cases = [
        // (line, rejected before, rejected after)
        (rejected(&near, "pcm"), None),
        (rejected(&wrong, "pcm"), Some("pcm")),
        (near.clone(), None),
        (wrong.clone(), Some("pcm")),
        (rejected(&near, "multicut"), Some("multicut")),
        (lone, None),
        // Between two parts of the map nothing is predicted: the edge stays what it was.
        (rejected(&unpredicted, "pcm"), Some("pcm")),
        (unpredicted.clone(), None),
    ];
    for (line, expected) in cases {
        let mut graph = with(nodes(5), std::slice::from_ref(&line));
        let result = readmit(&mut graph, &READMISSION).unwrap();
        assert_eq!(graph.edges[0].rejected_by.as_deref(), expected, "{line}");
        assert_eq!(result.tested + result.rejected_by_others, 1);
    }
}

/// Places along 40 m; `count` edges in use that are off by `off` metres, and one rejected edge off by `rejected` metres.
fn used_and_rejected(count: u64, off: f64, rejected: f64, variance: f64) -> PoseGraph {
    let terms = format!("[{variance},0,0,{variance},0,{variance}]");
    let mut lines = Vec::new();
    for to in 1..=count {
        let line = edge("landmark", 100 + to, 0, to, GOOD)
            .replace(&format!("[{to},0,0]"), &format!("[{},0,0]", to as f64 + off));
        lines.push(predicted(&line, "[1e-6,0,0,1e-6,0,1e-6]"));
    }
    let last = count + 1;
    let line = edge("landmark", 999, 0, last, GOOD)
        .replace(&format!("[{last},0,0]"), &format!("[{},0,0]", last as f64 + rejected));
    lines.push(predicted(&line, &terms).replace('}', r#","rejected_by":"pcm"}"#));
    with(nodes(count as usize + 2), &lines)
}

#[test]
fn false_edges_in_use_do_not_raise_the_scale_without_bound() {
    // Everything in use is 3 m off at 0.1 m: the estimate would be 144.
    let mut graph = used_and_rejected(38, 3.0, 3.0, 1e-6);
    let result = readmit(&mut graph, &Readmission { scale: None, ..READMISSION }).unwrap();
    assert!(result.unbounded_scale.is_some_and(|scale| scale > 100.0), "{result:?}");
    assert_eq!((result.scale, result.readmitted), (9.0, 0));
    assert!(graph.edges.last().unwrap().rejected_by.is_some());
}

#[test]
fn an_edge_that_agrees_by_chance_is_not_readmitted() {
    // The map knows the place to 30 m only: among 39 edges along 40 m, agreement says nothing.
    let mut graph = used_and_rejected(38, 0.05, 20.0, 900.0);
    let result = readmit(&mut graph, &READMISSION).unwrap();
    assert_eq!((result.readmitted, result.by_chance), (0, 1), "{result:?}");
    // Known to a few centimetres, the same agreement is evidence.
    let mut graph = used_and_rejected(38, 0.05, 0.05, 0.001);
    let result = readmit(&mut graph, &READMISSION).unwrap();
    assert_eq!((result.readmitted, result.by_chance), (1, 0), "{result:?}");
}

#[test]
fn the_innovation_of_an_edge_in_use_leaves_the_edge_out() {
    // One direction, scalar: measured 0.3 with variance 0.01, predicted by all others as 0 with variance 0.04. The
    // estimate with both is 0.24, of variance 0.008; the innovation 0.3^2 / (0.01 + 0.04) = 1.8.
    let line = predicted(&edge("landmark", 1, 0, 1, GOOD), "[0.008,0,0,0.005,0,0.001]");
    let mut lines = nodes(2);
    lines[1] = r#"{"kind":"node","id":1,"pose":[0.24,0,0]}"#.to_owned();
    let mut graph = with(lines, &[line.replace("[1,0,0]", "[0.3,0,0]")]);
    readmit(&mut graph, &READMISSION).unwrap();
    let innovation = graph.edges[0].extra["pcm_innovation"].as_f64().unwrap();
    assert!((innovation - 1.8).abs() < 1e-4, "{innovation}");
}

#[test]
fn readmission_without_marginals_says_what_to_run() {
    for (line, words) in [
        (edge("landmark", 4, 0, 1, GOOD), "is missing"),
        (predicted(&edge("landmark", 4, 0, 1, GOOD), "[1,2]"), "does not fit"),
        (predicted(&edge("landmark", 4, 0, 1, GOOD), r#"["a"]"#), "is no list of numbers"),
    ] {
        let error = readmit(&mut with(nodes(2), &[line]), &READMISSION).unwrap_err().to_string();
        assert!(
            error.contains("landmark 4") && error.contains(words) && error.contains("--marginals"),
            "{error}"
        );
    }
    let bare = vec![r#"{"kind":"node","id":0}"#.to_owned(), r#"{"kind":"node","id":1}"#.to_owned()];
    let line = predicted(&edge("landmark", 4, 0, 1, GOOD), "[1,0,0,1,0,1]");
    let error = readmit(&mut with(bare, &[line]), &READMISSION).unwrap_err().to_string();
    assert!(error.contains("node 0") && error.contains("no pose"), "{error}");
}

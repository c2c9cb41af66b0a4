//! Degenerate graphs: each has a defined result, and nothing panics.

use posecut_geometry::SE2;
use posecut_graph::PoseGraph;
use posecut_verify::verdict::Verdict;
use posecut_verify::{Verification, verify};

const GOOD: &str = "[100,0,0,100,0,400]";

fn edge(kind: &str, id: usize, (from, to): (usize, usize), measurement: &str, information: &str) -> String {
    format!(
        r#"{{"kind":"{kind}","id":{id},"from":{from},"to":{to},"measurement":{measurement},"information":{information}}}"#
    )
}

/// Two chains of `count` nodes each, with steps of one metre, and these landmark edges.
fn graph(count: usize, step: &str, landmarks: &[String]) -> PoseGraph {
    let mut lines = vec![r#"{"kind":"header","format":"posecut","version":1,"dimension":2}"#.to_owned()];
    lines.extend((0..2 * count).map(|id| format!(r#"{{"kind":"node","id":{id}}}"#)));
    let steps = (1..2 * count).filter(|node| node % count != 0);
    lines.extend(steps.map(|node| edge("odometry", node, (node - 1, node), step, GOOD)));
    lines.extend_from_slice(landmarks);
    PoseGraph::read("test", format!("{}\n", lines.join("\n")).as_bytes()).unwrap()
}

fn judged(graph: &PoseGraph) -> Verification {
    verify::<SE2, 3>(graph).unwrap()
}

#[test]
fn a_graph_without_landmark_edges_passes() {
    let verification = judged(&graph(3, "[1,0,0]", &[]));
    assert!(verification.findings.is_empty());
    assert_eq!(verification.joins_proposed, 0);
    assert!(judged(&graph(0, "[1,0,0]", &[])).findings.is_empty(), "an empty graph");
}

#[test]
fn a_lone_candidate_between_two_chains_is_undecided() {
    let one = [edge("landmark", 100, (1, 11), "[0,0,0]", GOOD)];
    let verification = judged(&graph(10, "[1,0,0]", &one));
    assert_eq!(verification.findings[0].verdict, Verdict::Undecided);
    assert_eq!((verification.joins_proposed, verification.joins_established), (1, 0));
}

#[test]
fn edges_without_measurement_are_counted_and_left_alone() {
    let mut lines: Vec<String> =
        (0..8).map(|k| edge("landmark", 100 + k, (k, 20 + k), "[0,0,0]", GOOD)).collect();
    lines.push(r#"{"kind":"landmark","id":200,"from":0,"to":39}"#.to_owned());
    let verification = judged(&graph(20, "[1,0,0]", &lines));
    assert_eq!((verification.findings.len(), verification.unmeasured), (8, 1));
}

#[test]
fn singular_information_zero_odometry_and_equal_candidates_are_judged() {
    let singular: Vec<String> = (0..8)
        .map(|k| edge("landmark", 100 + k, (2 * k, 20 + 2 * k), "[0,0,0]", "[100,0,0,100,0,0]"))
        .collect();
    assert_eq!(judged(&graph(20, "[1,0,0]", &singular)).findings.len(), 8);
    let standing: Vec<String> =
        (0..8).map(|k| edge("landmark", 100 + k, (2 * k, 20 + 2 * k), "[0,0,0]", GOOD)).collect();
    assert_eq!(judged(&graph(20, "[0,0,0]", &standing)).findings.len(), 8, "a robot that never moves");
    let equal: Vec<String> = (0..30).map(|k| edge("landmark", 100 + k, (3, 25), "[0,0,0]", GOOD)).collect();
    assert_eq!(judged(&graph(20, "[1,0,0]", &equal)).findings.len(), 30, "thirty times the same edge");
}

#[test]
fn indefinite_information_is_refused_with_the_edge() {
    let sound = [edge("landmark", 100, (0, 21), "[0,0,0]", GOOD)];
    let mut graph = graph(20, "[1,0,0]", &sound);
    // The reader rejects this information matrix, but a caller of the library may still pass it.
    graph.edges.last_mut().unwrap().information = Some(vec![-1.0, 0.0, 0.0, 1.0, 0.0, 1.0]);
    let error = verify::<SE2, 3>(&graph).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("landmark 100"), "{error}");
}

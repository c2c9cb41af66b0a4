//! Extreme graphs, beyond those of `bad_input`: every edge gets an answer, nothing panics, and correct edges are not lost.

use std::fmt::Write as _;

use posecut_geometry::{SE2, SE3};
use posecut_graph::PoseGraph;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_verify::verdict::Verdict;
use posecut_verify::{Verification, verify};

const GOOD: &str = "[100,0,0,100,0,400]";

/// Edges as from, to, measurement, information; the last two as JSON.
type Edge<'a> = (usize, usize, String, &'a str);

/// One chain of `count` nodes whose steps all have this measurement and information, and landmark edges with ids from 1000.
fn chain(count: usize, step: &str, information: &str, landmarks: &[Edge]) -> PoseGraph {
    let mut text =
        String::from("{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n");
    for id in 0..count {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{{\"kind\":\"node\",\"id\":{id}}}");
    }
    let mut edge = |kind: &str, id: usize, (from, to, measurement, information): &Edge| {
        let _ = writeln!(
            text,
            "{{\"kind\":\"{kind}\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":{measurement},\"information\":{information}}}"
        );
    };
    for to in 1..count {
        edge("odometry", to, &(to - 1, to, step.to_owned(), information));
    }
    for (place, own) in landmarks.iter().enumerate() {
        edge("landmark", 1000 + place, own);
    }
    PoseGraph::read("test", text.as_bytes()).unwrap()
}

/// Judges a graph, and checks what must hold for every answer.
fn judged(graph: &PoseGraph) -> Verification {
    let verification = verify::<SE2, 3>(graph).unwrap();
    for finding in &verification.findings {
        assert!((0.0..=1.0).contains(&finding.probability), "{finding:?}");
        assert!(finding.ratio.is_none_or(f64::is_finite), "{finding:?}");
        assert_eq!(finding.verdict == Verdict::Accepted, finding.hypothesis == Some(0), "{finding:?}");
    }
    verification
}

/// Edges over `steps` steps of one metre each that measure the odometry plus an error of `error` metres.
fn loops(count: usize, steps: usize, error: f64, information: &str) -> Vec<Edge<'_>> {
    (0..count)
        .map(|from| (from, from + steps, format!("[{},0,0]", steps as f64 + error), information))
        .collect()
}

#[test]
fn one_candidate_of_a_chain_is_judged_by_the_odometry() {
    let verdict =
        |error: f64| judged(&chain(60, "[1,0,0]", GOOD, &loops(1, 40, error, GOOD))).findings[0].verdict;
    assert_ne!(verdict(0.0), Verdict::Rejected, "it measures what the odometry says");
    assert_ne!(verdict(1e6), Verdict::Accepted, "it measures a thousand kilometres");
}

#[test]
fn edges_without_measurement_alone_leave_nothing_to_judge() {
    let mut graph = chain(20, "[1,0,0]", GOOD, &loops(4, 10, 0.0, GOOD));
    for edge in graph.edges.iter_mut().skip(19) {
        edge.measurement = None;
    }
    let verification = judged(&graph);
    assert_eq!((verification.findings.len(), verification.unmeasured), (0, 4));
}

#[test]
fn singular_odometry_is_judged() {
    for information in ["[0,0,0,0,0,0]", "[100,0,0,0,0,0]", "[100,0,0,100,0,0]", "[1e-80,0,0,1e-80,0,1e-80]"]
    {
        let verification = judged(&chain(40, "[1,0,0]", information, &loops(20, 15, 0.0, GOOD)));
        assert_eq!(verification.findings.len(), 20, "{information}");
        let verification = judged(&chain(40, "[1,0,0]", GOOD, &loops(20, 15, 0.0, information)));
        assert_eq!(verification.findings.len(), 20, "{information}");
        assert_eq!(
            verification.count(Verdict::Rejected),
            0,
            "{information}: no edge contradicts the odometry"
        );
    }
}

#[test]
fn information_and_measurements_of_any_size_are_judged() {
    for information in [
        "[1e15,0,0,1e15,0,1e15]",
        "[1e-300,0,0,1e-300,0,1e-300]",
        "[1e-12,0,0,1e-12,0,1e-12]",
        "[1e9,0,0,1e-9,0,1]",
    ] {
        assert_eq!(
            judged(&chain(40, "[1,0,0]", information, &loops(20, 15, 0.0, information))).findings.len(),
            20
        );
    }
    for step in ["[1e-9,0,0]", "[1e7,0,0]", "[0,0,3.141592653589793]", "[0,0,0]"] {
        assert_eq!(judged(&chain(40, step, GOOD, &loops(20, 15, 0.0, GOOD))).findings.len(), 20, "{step}");
    }
}

#[test]
fn a_robot_that_stands_keeps_edges_that_say_so() {
    let still: Vec<Edge> = (0..20).map(|from| (from, from + 15, "[0,0,0]".to_owned(), GOOD)).collect();
    let verification = judged(&chain(40, "[0,0,0]", GOOD, &still));
    assert_eq!(verification.count(Verdict::Rejected), 0);
}

#[test]
fn equal_candidates_do_not_support_each_other_against_the_odometry() {
    // A thousand copies of one wrong measurement: 30 m off, over 30 steps with a standard deviation of 0.1 m each.
    let equal: Vec<Edge> = (0..1000).map(|_| (5, 35, "[60,0,0]".to_owned(), GOOD)).collect();
    let verification = judged(&chain(40, "[1,0,0]", GOOD, &equal));
    assert_eq!(verification.findings.len(), 1000);
    let first = verification.findings[0].verdict;
    assert!(
        verification.findings.iter().all(|finding| finding.verdict == first),
        "equal edges, equal verdicts"
    );
    assert_ne!(first, Verdict::Accepted);
}

#[test]
fn edges_between_neighbours_and_along_the_odometry_are_judged() {
    let beside: Vec<Edge> = (0..39).map(|from| (from, from + 1, "[1,0,0]".to_owned(), GOOD)).collect();
    let verification = judged(&chain(40, "[1,0,0]", GOOD, &beside));
    assert_eq!(verification.findings.len(), 39);
    assert_eq!(verification.count(Verdict::Rejected), 0);
}

#[test]
fn ten_thousand_consistent_candidates_are_all_kept() {
    let scenario = Scenario { candidates: 10_000, outliers: 0.0, falsehood: Falsehood::Uniform, seed: 3 };
    let verification = judged(&scenario.draw::<SE2, 3>());
    assert_eq!((verification.findings.len(), verification.count(Verdict::Accepted)), (10_000, 10_000));
}

#[test]
fn two_thousand_consistent_candidates_in_space_are_all_kept() {
    let scenario = Scenario { candidates: 2000, outliers: 0.0, falsehood: Falsehood::Uniform, seed: 3 };
    let verification = verify::<SE3, 6>(&scenario.draw::<SE3, 6>()).unwrap();
    assert_eq!((verification.findings.len(), verification.count(Verdict::Accepted)), (2000, 2000));
}

/// Wrong neighbours lead from near positions to near positions, and odometry with a large covariance explains them. Its
/// variance was estimated some hundred times too large, and correct edges were lost.
#[test]
fn nine_wrong_edges_of_ten_are_not_taken_for_a_loose_odometry() {
    for candidates in [300, 1000] {
        let scenario = Scenario { candidates, outliers: 0.9, falsehood: Falsehood::Uniform, seed: 3 };
        let graph = scenario.draw::<SE2, 3>();
        let verification = judged(&graph);
        assert!(verification.calibration.odometry.iter().all(|factor| *factor < 10.0));
        for finding in &verification.findings {
            let correct = graph.edges[finding.edge].truth.as_ref().and_then(|truth| truth.correct);
            assert_eq!(correct == Some(true), finding.verdict == Verdict::Accepted, "{finding:?}");
        }
    }
}

//! Findings about factors on covariances.

use posecut_doctor::{Effort, Severity, examine, examine_by, examine_with};
use posecut_geometry::SE2;
use posecut_graph::{Dimension, EdgeKind, PoseGraph};

use crate::drives::{LAP, ODOMETRY, edges_of, information, laps, plane};
use crate::{absent, find, found};

/// The drive with odometry covariances multiplied by a factor.
fn scaled(factor: f64) -> PoseGraph {
    let mut graph = plane();
    for edge in edges_of(&mut graph, EdgeKind::Odometry) {
        let deviations = ODOMETRY.map(|deviation| deviation * factor.sqrt());
        edge.information = Some(information(Dimension::Two, deviations));
    }
    graph
}

#[test]
fn covariances_that_fit_the_loops_are_noted() {
    let finding = found(&plane(), "calibration", Severity::Note);
    assert_eq!(finding.numbers["candidates"], 120);
    assert!(finding.numbers["evidence"].as_f64().unwrap() > 10.0, "{finding:?}");
    assert_eq!(finding.numbers["chains"][0]["session"], "drive");
    assert_eq!(finding.numbers["chains"][0]["nodes"], 240);
}

#[test]
fn covariances_that_do_not_fit_are_reported() {
    let finding = found(&scaled(400.0), "calibration", Severity::Warning);
    assert!(
        finding.consequence.contains("too large (of odometry") && !finding.consequence.contains("too small")
    );
    let finding = found(&scaled(0.0025), "calibration", Severity::Warning);
    assert!(finding.consequence.contains("too small (of odometry"), "{finding:?}");
}

/// The factors of chains are those of the right sessions: the odometry of the last one is far worse than it states.
#[test]
fn factors_are_given_by_session() {
    let mut graph = laps(3);
    for edge in edges_of(&mut graph, EdgeKind::Odometry).filter(|edge| edge.from >= 2 * LAP as u64) {
        edge.measurement.as_mut().unwrap()[0] += 0.6 * ((edge.from * 7919 % 101) as f64 / 50.0 - 1.0);
    }
    for (index, node) in graph.nodes.iter_mut().enumerate() {
        node.session = Some(["c", "a", "b"][index / LAP].to_owned());
    }
    let last = LAP as u64 - 1;
    graph.edges.retain(|edge| edge.kind == EdgeKind::Landmark || edge.from % LAP as u64 != last);
    let finding = found(&graph, "calibration", Severity::Note);
    let chains = finding.numbers["chains"].as_array().unwrap();
    let factor = |session: &str| {
        chains.iter().find(|chain| chain["session"] == session).unwrap()["odometry"].as_f64().unwrap()
    };
    assert_eq!(chains.len(), 3);
    assert!(factor("b") > 5.0 * factor("a") && factor("b") > 5.0 * factor("c"), "{chains:?}");
}

#[test]
fn too_little_evidence_is_reported() {
    let mut graph = plane();
    absent(&graph, "no-calibration");
    graph.edges.retain(|edge| edge.kind == EdgeKind::Odometry || edge.from == 30);
    found(&graph, "no-calibration", Severity::Warning);
}

/// One step that measures ten metres too many, in the middle of the first lap.
#[test]
fn broken_odometry_is_named() {
    let mut graph = plane();
    absent(&graph, "broken-odometry");
    for edge in edges_of(&mut graph, EdgeKind::Odometry).filter(|edge| edge.from == 150) {
        edge.measurement = Some(vec![14.0, 9.0, 1.9]);
    }
    let finding = found(&graph, "broken-odometry", Severity::Warning);
    assert_eq!(finding.numbers["edges"], serde_json::json!([150]));
}

/// The second lap is 15 % longer than the first.
#[test]
fn odometry_that_accumulates_errors_is_reported() {
    let mut graph = plane();
    absent(&graph, "coherent-odometry");
    for edge in edges_of(&mut graph, EdgeKind::Odometry) {
        if edge.from >= LAP as u64 {
            edge.measurement.as_mut().unwrap()[0] *= 1.15;
        }
        edge.information = Some(information(Dimension::Two, [0.01, 0.0005]));
    }
    found(&graph, "coherent-odometry", Severity::Warning);
}

/// The caller's verification is used, and none is made without one.
#[test]
fn a_verification_can_be_given() {
    let graph = plane();
    let verification = posecut_verify::verify::<SE2, 3>(&graph).unwrap();
    assert_eq!(examine_with(&graph, Some(&verification)), examine(&graph));
    assert_eq!(find(&examine_with(&graph, None), "calibration"), None);
    assert_eq!(examine_by(&graph, Effort::Thorough), examine(&graph));
}

#[test]
fn many_landmark_edges_are_calibrated_on_request_only() {
    let mut graph = plane();
    absent(&graph, "calibration-skipped");
    for id in 0..20_000 {
        let mut edge = graph.edges[240 + id % 120].clone();
        edge.id = 10_000 + id as u64;
        graph.edges.push(edge);
    }
    let finding = found(&graph, "calibration-skipped", Severity::Note);
    assert!(finding.remedy.contains("--thorough"), "{finding:?}");
    absent(&graph, "calibration");
}

#[test]
fn a_graph_that_cannot_be_verified_says_why() {
    let mut graph = plane();
    // Not positive definite by more than rounding, which readers refuse.
    edges_of(&mut graph, EdgeKind::Odometry).nth(3).unwrap().information =
        Some(vec![1.0, 2.0, 0.0, 1.0, 0.0, 1.0]);
    let finding = found(&graph, "verification-failed", Severity::Error);
    assert!(finding.title.contains("odometry 3"), "{finding:?}");
}

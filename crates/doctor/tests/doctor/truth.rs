//! Findings about ground truth.

use posecut_doctor::{Finding, Severity};
use posecut_graph::{Dimension, EdgeKind, EdgeTruth, PoseGraph};

use crate::drives::{LANDMARK, ODOMETRY, edges_of, information, plane, space};
use crate::{absent, found};

/// The normalised errors by the length of the windows.
fn nees(finding: &Finding) -> Vec<f64> {
    let windows = finding.numbers["windows"].as_array().unwrap();
    windows.iter().map(|window| window["value"].as_f64().unwrap()).collect()
}

/// The drive with covariances of a kind multiplied by a factor.
fn scaled(kind: EdgeKind, factor: f64) -> PoseGraph {
    let mut graph = plane();
    let deviations = if kind == EdgeKind::Odometry { ODOMETRY } else { LANDMARK };
    for edge in edges_of(&mut graph, kind) {
        edge.information =
            Some(information(Dimension::Two, deviations.map(|deviation| deviation * factor.sqrt())));
    }
    graph
}

#[test]
fn right_covariances_have_a_nees_of_one_over_all_windows() {
    for graph in [plane(), space()] {
        let finding = found(&graph, "odometry-nees", Severity::Note);
        let values = nees(&finding);
        assert_eq!(values.len(), 3, "windows of 1, 10 and 100 steps");
        assert!((0.8..1.25).contains(&values[0]) && (0.5..2.0).contains(&values[1]), "{values:?}");
        let expected = finding.numbers["windows"][0]["expected"].as_array().unwrap();
        assert!(expected[0].as_f64().unwrap() < values[0] && values[0] < expected[1].as_f64().unwrap());
        let landmark = nees(&found(&graph, "landmark-nees", Severity::Note));
        assert!((0.8..1.25).contains(&landmark[0]), "{landmark:?}");
    }
}

#[test]
fn wrong_covariances_are_reported_with_the_factor_that_corrects_them() {
    for (kind, name, argument) in [
        (EdgeKind::Odometry, "odometry-nees", "posecut pcm --scale 0.0"),
        (EdgeKind::Landmark, "landmark-nees", "posecut pcm --scale 1,0.0"),
    ] {
        let large = found(&scaled(kind, 25.0), name, Severity::Warning);
        assert!(large.consequence.contains("too large") && large.remedy.contains(argument), "{large:?}");
        let small = found(&scaled(kind, 0.04), name, Severity::Warning);
        assert!(small.consequence.contains("too small"), "{small:?}");
        found(&scaled(kind, 3.0), name, Severity::Note);
    }
}

/// The truth has errors of its own, which do not add up over a window.
#[test]
fn noise_of_the_truth_is_no_fault_of_the_odometry() {
    let mut graph = plane();
    for (index, node) in graph.nodes.iter_mut().enumerate() {
        let pose = node.truth.as_mut().unwrap().pose.as_mut().unwrap();
        pose[0] += 0.6 * ((index * 7919 % 101) as f64 / 50.0 - 1.0);
    }
    let finding = found(&graph, "odometry-nees", Severity::Note);
    assert!(nees(&finding)[0] > 10.0 && finding.consequence.contains("noise of the truth"), "{finding:?}");
}

#[test]
fn wheels_that_over_read_lengthen_the_path() {
    found(&plane(), "path-length", Severity::Note);
    let mut graph = plane();
    for edge in edges_of(&mut graph, EdgeKind::Odometry) {
        edge.measurement.as_mut().unwrap()[0] *= 1.08;
    }
    let finding = found(&graph, "path-length", Severity::Warning);
    assert!((finding.numbers["ratio"].as_f64().unwrap() - 1.08).abs() < 0.01, "{finding:?}");
}

#[test]
fn truth_and_labels_are_counted() {
    let mut graph = plane();
    for edge in edges_of(&mut graph, EdgeKind::Landmark).take(7) {
        edge.truth = Some(EdgeTruth::of(false));
    }
    let finding = found(&graph, "truth", Severity::Note);
    assert_eq!((&finding.numbers["correct"], &finding.numbers["incorrect"]), (&113.into(), &7.into()));
    for node in &mut graph.nodes {
        node.truth = None;
    }
    found(&graph, "truth", Severity::Note);
    for edge in &mut graph.edges {
        edge.truth = None;
    }
    for name in ["truth", "path-length", "odometry-nees", "landmark-nees"] {
        absent(&graph, name);
    }
}

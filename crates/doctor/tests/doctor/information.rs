//! Findings about information matrices.

use posecut_doctor::Severity;
use posecut_geometry::{LieGroup as _, SE2};
use posecut_graph::{Dimension, EdgeKind, PoseGraph};

use crate::drives::{LANDMARK, ODOMETRY, edges_of, information, laps, motion, plane, space};
use crate::{absent, found};

/// The drive with these standard deviations, metres and radians, on all edges of a kind.
fn stated(kind: EdgeKind, deviations: [f64; 2]) -> PoseGraph {
    let mut graph = plane();
    for edge in edges_of(&mut graph, kind) {
        edge.information = Some(information(Dimension::Two, deviations));
    }
    graph
}

#[test]
fn deviations_are_noted_in_metres_and_degrees() {
    for graph in [plane(), space()] {
        let finding = found(&graph, "odometry-deviations", Severity::Note);
        let number = |name: &str| finding.numbers[name].as_f64().unwrap();
        assert!((number("deviation_translation") - ODOMETRY[0]).abs() < 1e-9);
        assert!((number("deviation_rotation") - ODOMETRY[1].to_degrees()).abs() < 1e-9);
        assert!((1.0..2.5).contains(&number("median_translation")), "{finding:?}");
        assert_eq!(finding.numbers["matrices"], 1);
        assert_eq!(found(&graph, "landmark-deviations", Severity::Note).numbers["edges"], 120);
    }
}

#[test]
fn deviations_that_no_sensor_has_are_reported() {
    for (kind, deviations, name) in [
        (EdgeKind::Odometry, [1e-4, 0.004], "translation-too-certain"),
        (EdgeKind::Landmark, [1e-4, 0.02], "translation-too-certain"),
        (EdgeKind::Odometry, [100.0, 0.004], "translation-too-uncertain"),
        (EdgeKind::Odometry, [9.0, 0.004], "translation-too-uncertain"),
        (EdgeKind::Landmark, [100.0, 0.02], "translation-too-uncertain"),
        (EdgeKind::Odometry, [0.03, 1e-6], "rotation-too-certain"),
        (EdgeKind::Landmark, [0.1, 2.0], "rotation-too-uncertain"),
    ] {
        let finding = found(&stated(kind, deviations), name, Severity::Warning);
        assert_eq!(finding.numbers["kind"], kind.name());
        absent(&plane(), name);
    }
    // Loose landmark edges are no fault: a recogniser may be that vague.
    absent(&stated(EdgeKind::Landmark, [9.0, 0.3]), "translation-too-uncertain");
}

#[test]
fn a_heading_in_degrees_and_a_covariance_are_told_apart() {
    let degrees =
        found(&stated(EdgeKind::Odometry, [0.03, 2.0]), "rotation-too-uncertain", Severity::Warning);
    assert!(
        degrees.remedy.contains("if 2 degrees are meant, the information is in 1/degree^2"),
        "{degrees:?}"
    );
    assert!(!degrees.remedy.contains("covariance: invert"), "{degrees:?}");
    let inverse =
        found(&stated(EdgeKind::Odometry, [0.03, 50.0]), "rotation-too-uncertain", Severity::Warning);
    assert!(inverse.remedy.contains("if 1.15 degrees are meant, it is a covariance"), "{inverse:?}");
    assert!(!inverse.remedy.contains("1/degree^2"), "{inverse:?}");
}

#[test]
fn singular_matrices_are_counted_with_the_first() {
    let mut graph = plane();
    absent(&graph, "singular-information");
    edges_of(&mut graph, EdgeKind::Landmark).nth(5).unwrap().information =
        Some(vec![1.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
    let finding = found(&graph, "singular-information", Severity::Warning);
    assert_eq!((&finding.numbers["edges"], &finding.numbers["first"]), (&1.into(), &245.into()));
    for edge in edges_of(&mut graph, EdgeKind::Odometry) {
        edge.information = Some(vec![1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    }
    let finding = found(&graph, "singular-information", Severity::Error);
    assert_eq!(finding.numbers["kind"], "odometry");
}

#[test]
fn an_edge_that_weighs_more_than_ten_thousand_others_is_reported() {
    let mut graph = plane();
    absent(&graph, "information-outliers");
    edges_of(&mut graph, EdgeKind::Landmark).nth(9).unwrap().information =
        Some(information(Dimension::Two, [LANDMARK[0] / 150.0, LANDMARK[1]]));
    let finding = found(&graph, "information-outliers", Severity::Warning);
    assert_eq!(finding.numbers["smallest"], 249);
}

#[test]
fn one_number_for_metres_and_radians_is_a_placeholder() {
    for name in ["placeholder", "odometry-placeholder", "landmark-placeholder"] {
        absent(&plane(), name);
    }
    let identity = found(&stated(EdgeKind::Odometry, [1.0, 1.0]), "odometry-placeholder", Severity::Warning);
    assert!(identity.title.contains("have the identity as information matrix: 1 m and 57.3 degrees"));
    let multiple = found(&stated(EdgeKind::Landmark, [0.1, 0.1]), "landmark-placeholder", Severity::Warning);
    assert_eq!(multiple.numbers["factor"].as_f64().unwrap().round(), 100.0);
    let mut both = stated(EdgeKind::Odometry, [0.1, 0.1]);
    for edge in edges_of(&mut both, EdgeKind::Landmark) {
        edge.information = Some(information(Dimension::Two, [0.1, 0.1]));
    }
    found(&both, "placeholder", Severity::Warning);
    for name in ["odometry-placeholder", "landmark-placeholder", "shared-information"] {
        absent(&both, name);
    }
}

/// Estimated factors are uncertain, so only very different ones contradict a shared matrix.
#[test]
fn one_matrix_for_all_edges_is_reported_unless_the_loops_allow_it() {
    absent(&plane(), "shared-information");
    // Landmark edges as good as odometry: the same place in both laps is truly the identity.
    let mut equal = laps(3);
    for edge in edges_of(&mut equal, EdgeKind::Landmark) {
        edge.measurement = Some(SE2::identity().interpolate(&motion(edge), 0.25).components());
        edge.information = Some(information(Dimension::Two, ODOMETRY));
    }
    let allowed = found(&equal, "shared-information", Severity::Note);
    assert!(allowed.title.contains("all 359 odometry edges and all 360 landmark edges"), "{allowed:?}");
    let mut graph = stated(EdgeKind::Landmark, ODOMETRY);
    for edge in edges_of(&mut graph, EdgeKind::Landmark) {
        edge.measurement.as_mut().unwrap()[0] += (edge.id * 7919 % 101) as f64 / 50.0 - 1.0;
    }
    found(&graph, "shared-information", Severity::Warning);
    // Without loops to compare with, it is suspect.
    let mut single = stated(EdgeKind::Odometry, LANDMARK);
    single.edges.retain(|edge| edge.kind == EdgeKind::Odometry || edge.from < 3);
    found(&single, "shared-information", Severity::Warning);
}

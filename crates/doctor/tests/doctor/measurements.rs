//! Findings about measured motions.

use posecut_doctor::Severity;
use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::EdgeKind;

use crate::drives::{edges_of, plane, space};
use crate::{absent, found};

#[test]
fn degrees_are_recognised_by_headings_beyond_a_full_turn() {
    let mut graph = plane();
    absent(&graph, "degrees");
    for edge in edges_of(&mut graph, EdgeKind::Odometry) {
        edge.measurement.as_mut().unwrap()[2] *= 57.3 * 3.0;
    }
    let finding = found(&graph, "degrees", Severity::Error);
    assert_eq!(finding.numbers["kind"], "odometry");
    let mut graph = plane();
    edges_of(&mut graph, EdgeKind::Landmark).next().unwrap().measurement.as_mut().unwrap()[2] = 7.0;
    assert_eq!(found(&graph, "degrees", Severity::Warning).numbers["edges"], 1);
}

#[test]
fn quaternions_with_w_first_turn_around_at_every_step() {
    let mut graph = space();
    absent(&graph, "quaternion-order");
    for edge in &mut graph.edges {
        edge.measurement.as_mut().unwrap()[3..].rotate_right(1);
    }
    assert_eq!(found(&graph, "quaternion-order", Severity::Error).numbers["of"], 239);
}

#[test]
fn millimetres_are_long_steps() {
    let mut graph = plane();
    absent(&graph, "long-steps");
    for edge in &mut graph.edges {
        edge.measurement.as_mut().unwrap()[..2].iter_mut().for_each(|length| *length *= 1000.0);
    }
    found(&graph, "long-steps", Severity::Warning);
}

#[test]
fn odometry_without_motion_is_reported() {
    let mut graph = plane();
    absent(&graph, "no-motion");
    for edge in edges_of(&mut graph, EdgeKind::Odometry).take(100) {
        edge.measurement = Some(vec![0.0; 3]);
    }
    absent(&graph, "no-motion");
    for edge in edges_of(&mut graph, EdgeKind::Odometry).take(130) {
        edge.measurement = Some(vec![0.0; 3]);
    }
    assert_eq!(found(&graph, "no-motion", Severity::Warning).numbers["edges"], 130);
}

#[test]
fn edges_without_measurement_are_counted() {
    let mut graph = plane();
    absent(&graph, "unmeasured");
    for edge in edges_of(&mut graph, EdgeKind::Landmark).take(3) {
        (edge.measurement, edge.information) = (None, None);
    }
    assert_eq!(found(&graph, "unmeasured", Severity::Note).numbers["edges"], 3);
    for edge in edges_of(&mut graph, EdgeKind::Landmark) {
        (edge.measurement, edge.information) = (None, None);
    }
    found(&graph, "unmeasured", Severity::Warning);
    absent(&graph, "no-calibration");
}

#[test]
fn place_recognition_without_geometry_is_recognised() {
    let mut graph = plane();
    absent(&graph, "without-geometry");
    absent(&graph, "partly-without-geometry");
    for edge in edges_of(&mut graph, EdgeKind::Landmark).take(60) {
        edge.measurement = Some(vec![0.0; 3]);
    }
    let finding = found(&graph, "partly-without-geometry", Severity::Warning);
    assert!(finding.title.starts_with("60 of 120 landmark edges (50 %)"), "{finding:?}");
    for edge in edges_of(&mut graph, EdgeKind::Landmark) {
        edge.measurement = Some(vec![0.0; 3]);
    }
    assert_eq!(found(&graph, "without-geometry", Severity::Warning).numbers["edges"], 120);
    absent(&graph, "repeated-measurement");
}

/// A few zeros are a coincidence of rounding.
#[test]
fn single_zeros_are_no_habit() {
    let mut graph = space();
    for edge in edges_of(&mut graph, EdgeKind::Landmark).take(4) {
        edge.measurement = Some(SE3::identity().components());
    }
    absent(&graph, "partly-without-geometry");
}

#[test]
fn a_measurement_that_many_edges_share_is_reported() {
    let mut graph = plane();
    absent(&graph, "repeated-measurement");
    for edge in edges_of(&mut graph, EdgeKind::Landmark).take(40) {
        edge.measurement = Some(vec![0.5, 0.0, 0.0]);
    }
    let finding = found(&graph, "repeated-measurement", Severity::Warning);
    assert_eq!((&finding.numbers["edges"], &finding.numbers["first"]), (&40.into(), &240.into()));
}

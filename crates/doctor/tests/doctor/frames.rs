//! Findings about poses and axes.

use posecut_doctor::Severity;
use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::EdgeKind;

use crate::drives::{edges_of, motion, plane, space};
use crate::{absent, found};

#[test]
fn the_origin_of_poses_is_told() {
    let mut graph = plane();
    assert!(found(&graph, "poses", Severity::Note).title.starts_with("the given poses are dead reckoning"));
    for node in &mut graph.nodes {
        node.pose.clone_from(&node.truth.as_ref().unwrap().pose);
    }
    let fitted = found(&graph, "poses", Severity::Note);
    assert!(fitted.title.starts_with("the given poses fit odometry and landmark edges"), "{fitted:?}");
    for (index, node) in graph.nodes.iter_mut().enumerate() {
        node.pose = Some(vec![(index * index) as f64 % 17.0, index as f64 % 11.0, 0.0]);
    }
    let other = found(&graph, "poses", Severity::Note);
    assert!(other.title.starts_with("the given poses do not fit the odometry"), "{other:?}");
    for node in &mut graph.nodes {
        node.pose = Some(vec![0.0; 3]);
    }
    assert!(found(&graph, "poses", Severity::Note).title.contains("have the same pose"));
    graph.nodes[0].pose = None;
    assert_eq!(found(&graph, "poses", Severity::Warning).numbers["with_pose"], 239);
    for node in &mut graph.nodes {
        node.pose = None;
    }
    assert!(found(&graph, "poses", Severity::Note).title.starts_with("no poses are given"));
}

#[test]
fn inverted_measurements_are_an_error() {
    let mut graph = plane();
    absent(&graph, "inverted-measurements");
    for edge in edges_of(&mut graph, EdgeKind::Odometry) {
        edge.measurement = Some(motion(edge).inverse().components());
    }
    found(&graph, "inverted-measurements", Severity::Error);
}

#[test]
fn poses_in_other_units_are_reported() {
    let mut graph = plane();
    absent(&graph, "pose-units");
    for node in &mut graph.nodes {
        node.pose.as_mut().unwrap()[..2].iter_mut().for_each(|position| *position *= 1000.0);
    }
    let finding = found(&graph, "pose-units", Severity::Warning);
    assert!((finding.numbers["ratio"].as_f64().unwrap() - 1e-3).abs() < 1e-6, "{finding:?}");
    let mut graph = plane();
    for edge in edges_of(&mut graph, EdgeKind::Odometry) {
        edge.measurement.as_mut().unwrap()[2] *= 10.0;
    }
    assert!(found(&graph, "pose-units", Severity::Warning).title.contains("turns by"));
}

/// Turns the world so that y is up, as in a camera's frame.
#[test]
fn the_axis_that_is_up_is_told() {
    let mut graph = space();
    assert_eq!(found(&graph, "up-axis", Severity::Note).numbers["up"], "z");
    let turn = SE3::from_euler(0.0, 0.0, 0.0, -std::f64::consts::FRAC_PI_2, 0.0, 0.0);
    for node in &mut graph.nodes {
        let pose = SE3::from_components(node.pose.as_deref().unwrap()).unwrap();
        node.pose = Some(turn.compose(&pose).components());
    }
    assert_eq!(found(&graph, "up-axis", Severity::Note).numbers["up"], "y");
    // Without poses, by dead reckoning.
    for node in &mut graph.nodes {
        node.pose = None;
    }
    assert_eq!(found(&graph, "up-axis", Severity::Note).numbers["up"], "z");
    absent(&plane(), "up-axis");
}

#[test]
fn planar_data_in_space_are_noted() {
    let mut graph = space();
    absent(&graph, "planar-data");
    for node in &mut graph.nodes {
        node.pose.as_mut().unwrap()[2] = 3.0;
    }
    found(&graph, "planar-data", Severity::Note);
    for (index, node) in graph.nodes.iter_mut().enumerate() {
        node.pose.as_mut().unwrap()[2] = index as f64 % 60.0;
    }
    found(&graph, "no-up-axis", Severity::Note);
}

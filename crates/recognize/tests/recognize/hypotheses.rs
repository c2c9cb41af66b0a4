//! Rival hypotheses of where a keyframe is.

use nalgebra::Matrix3;
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, PoseGraph};
use posecut_recognize::Routes;
use posecut_recognize::hypotheses::{Measured, odds, rivals};
use posecut_recognize::measure::Measurement;

/// A straight route of keyframes a metre apart, which breaks before keyframe 60.
fn routes() -> Routes {
    let mut graph = PoseGraph::new(Header::new(Dimension::Two));
    for id in 0..80 {
        graph.nodes.push(Node { id, ..Node::default() });
        if id > 0 && id != 60 {
            let mut edge = Edge::new(EdgeKind::Odometry, id - 1, id - 1, id);
            edge.measurement = Some(SE2::new(1.0, 0.0, 0.0).components());
            edge.information = Some(vec![1.0, 0.0, 0.0, 1.0, 0.0, 1.0]);
            graph.edges.push(edge);
        }
    }
    Routes::of_graph(&graph).unwrap()
}

/// The rivals of measurements (from, to, x, agreement).
fn rivals_of(measurements: &[(usize, usize, f64, f64)]) -> Vec<f64> {
    let made: Vec<Measurement> = measurements
        .iter()
        .map(|&(_, _, x, agreement)| Measurement {
            pose: SE2::new(x, 0.0, 0.0),
            information: Matrix3::identity(),
            agreement,
        })
        .collect();
    let measured: Vec<Measured<'_>> = measurements
        .iter()
        .zip(&made)
        .map(|(&(from, to, ..), measurement)| Measured { from, to, measurement })
        .collect();
    rivals(&routes(), &measured)
}

#[test]
fn a_keyframe_is_at_one_place() {
    // Keyframe 50 at keyframe 0 and at keyframe 20, which are 20 m apart.
    let found = rivals_of(&[(0, 50, 0.0, 0.7), (20, 50, 0.0, 0.5)]);
    assert_eq!(found, [odds(0.5), odds(0.7)]);
}

#[test]
fn passages_of_one_place_are_no_rivals() {
    // Both say that keyframe 50 is at x = 25, as far as odometry can tell.
    let found = rivals_of(&[(0, 50, 25.0, 0.7), (20, 50, 5.5, 0.5)]);
    assert_eq!(found, [0.0, 0.0]);
}

#[test]
fn neighbours_are_one_rival() {
    let found = rivals_of(&[(0, 50, 0.0, 0.7), (20, 50, 0.0, 0.5), (22, 50, -2.0, 0.6), (40, 50, 0.0, 0.4)]);
    assert_eq!(found[0], odds(0.6) + odds(0.4));
}

#[test]
fn of_other_routes_odometry_knows_nothing() {
    let found = rivals_of(&[(0, 50, 0.0, 0.7), (50, 70, 0.0, 0.5)]);
    assert_eq!(found, [0.0, 0.0]);
}

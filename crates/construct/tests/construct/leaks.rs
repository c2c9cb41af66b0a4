//! Checks that nothing in an incorrect edge reveals that it is incorrect.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use posecut_construct::{IncorrectKind, Options};
use posecut_graph::{EdgeKind, PoseGraph};

use crate::rounds::{construct, options, unsteady_rounds};

const KINDS: [IncorrectKind; 4] =
    [IncorrectKind::Uniform, IncorrectKind::Grouped, IncorrectKind::NearMiss, IncorrectKind::Corridor];

fn with(kind: IncorrectKind, rate: f64, seed: u64) -> PoseGraph {
    let options = Options { incorrect_kind: kind, incorrect_rate: rate, seed, ..options() };
    construct(vec![unsteady_rounds("s", 314)], &options).unwrap()
}

/// The measurements of landmark edges, each with its truth.
fn measured(graph: &PoseGraph) -> Vec<([f64; 3], bool)> {
    graph
        .edges_of(EdgeKind::Landmark)
        .map(|edge| {
            let measurement = edge.measurement.as_deref().unwrap();
            ([measurement[0], measurement[1], measurement[2]], edge.truth_correct().unwrap())
        })
        .collect()
}

#[test]
fn no_two_landmark_edges_have_the_same_measurement() {
    for kind in KINDS {
        let edges = measured(&with(kind, 0.5, 1));
        for axis in 0..3 {
            let different: BTreeSet<u64> = edges.iter().map(|(edge, _)| edge[axis].to_bits()).collect();
            assert_eq!(different.len(), edges.len(), "{kind:?}, axis {axis}");
        }
    }
}

/// For each edge the distance to the most similar other measurement, in metres (a radian counts as 5 m), and its truth.
fn isolation(edges: &[([f64; 3], bool)]) -> Vec<(f64, bool)> {
    let distance = |a: &[f64; 3], b: &[f64; 3]| {
        (a[0] - b[0]).hypot(a[1] - b[1]).hypot(5.0 * posecut_geometry::wrap_angle(a[2] - b[2]))
    };
    let nearest = |index: usize| {
        let others = edges.iter().enumerate().filter(|&(other, _)| other != index);
        others.map(|(_, (other, _))| distance(&edges[index].0, other)).fold(f64::INFINITY, f64::min)
    };
    edges.iter().enumerate().map(|(index, &(_, correct))| (nearest(index), correct)).collect()
}

#[test]
fn a_lookup_of_twins_finds_no_incorrect_edge() {
    // Probability that an incorrect edge has a nearer twin than a correct one: 1/2 if twins reveal nothing.
    let mut wins = 0.0;
    let mut pairs = 0.0;
    for seed in 1..=10 {
        let edges = isolation(&measured(&with(IncorrectKind::Uniform, 0.1, seed)));
        for (wrong, _) in edges.iter().filter(|edge| !edge.1) {
            for (right, _) in edges.iter().filter(|edge| edge.1) {
                wins += f64::from(wrong < right);
                pairs += 1.0;
            }
        }
    }
    let area = wins / pairs;
    // With about 330 incorrect edges, three standard errors are 0.05.
    assert!((area - 0.5).abs() < 0.06, "{area}");
}

/// The largest distance between two empirical distributions.
fn kolmogorov_smirnov(mut first: Vec<f64>, mut second: Vec<f64>) -> f64 {
    first.sort_by(f64::total_cmp);
    second.sort_by(f64::total_cmp);
    let share = |values: &[f64], limit: f64| {
        values.partition_point(|&value| value <= limit) as f64 / values.len() as f64
    };
    first
        .iter()
        .chain(&second)
        .map(|&value| (share(&first, value) - share(&second, value)).abs())
        .fold(0.0, f64::max)
}

/// Picks a number of a measurement.
type Value = fn(&[f64; 3]) -> f64;

#[test]
fn false_claims_are_distributed_as_correct_ones() {
    let edges = measured(&with(IncorrectKind::Uniform, 0.5, 1));
    let of = |wanted: bool, value: Value| -> Vec<f64> {
        edges.iter().filter(|edge| edge.1 == wanted).map(|edge| value(&edge.0)).collect()
    };
    let values: [(&str, Value); 4] = [
        ("x", |edge| edge[0]),
        ("y", |edge| edge[1]),
        ("heading", |edge| edge[2]),
        ("distance", |edge| edge[0].hypot(edge[1])),
    ];
    for (name, value) in values {
        let (right, wrong) = (of(true, value), of(false, value));
        let difference = kolmogorov_smirnov(right.clone(), wrong.clone());
        // Two samples of the same distribution are within this bound with probability 0.99.
        let bound = 1.63 * (1.0 / right.len() as f64 + 1.0 / wrong.len() as f64).sqrt();
        assert!(difference < bound, "{name}: {difference} against {bound} of {} edges", edges.len());
    }
}

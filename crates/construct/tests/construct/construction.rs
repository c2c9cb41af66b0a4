//! Tests what construction guarantees about edges, ids and random numbers.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use posecut_construct::Options;
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{EdgeKind, PoseGraph};
use proptest::prelude::*;

use crate::rounds::{construct, landmarks, options, rounds, truth};

#[test]
fn correct_edges_are_exactly_the_similar_pairs() {
    let graph = construct(vec![rounds("s", 314)], &options()).unwrap();
    let mut expected = BTreeSet::new();
    for first in &graph.nodes {
        for second in &graph.nodes {
            if first.session.as_deref() == Some("s/a") && second.session.as_deref() == Some("s/b") {
                let between = truth(&graph, first.id).between(&truth(&graph, second.id));
                if between.translation.norm() <= 3.0 && between.angle().abs() <= 30_f64.to_radians() {
                    expected.insert((first.id, second.id));
                }
            }
        }
    }
    assert!(expected.len() > 300);
    assert_eq!(landmarks(&graph, true).into_iter().collect::<BTreeSet<_>>(), expected);
}

#[test]
fn the_split_cuts_the_odometry_once_and_starts_the_second_half_anew() {
    let graph = construct(vec![rounds("s", 314)], &options()).unwrap();
    assert_eq!(graph.sessions(), ["s/a", "s/b"]);
    assert_eq!(graph.edges_of(EdgeKind::Odometry).count(), 312);
    assert!(graph.edges_of(EdgeKind::Odometry).all(|edge| (edge.from, edge.to) != (156, 157)));
    assert_eq!(
        graph.nodes[157].pose.as_deref(),
        Some(&[0.0, 0.0, 0.0][..]),
        "nothing tells where /b starts in /a"
    );
    assert_eq!(graph.nodes[157].frame, Some(157), "frames keep their numbers");
}

#[test]
fn ids_are_sorted_by_ends_and_tell_nothing_of_the_truth() {
    let graph = construct(vec![rounds("s", 314)], &Options { incorrect_rate: 0.4, ..options() }).unwrap();
    let ends: Vec<(u64, u64)> = graph.edges_of(EdgeKind::Landmark).map(|edge| (edge.from, edge.to)).collect();
    assert!(ends.is_sorted());
    let ids: Vec<u64> = graph.edges.iter().map(|edge| edge.id).collect();
    assert_eq!(ids, (0..graph.edges.len() as u64).collect::<Vec<_>>());
}

#[test]
fn raising_the_rate_keeps_the_correct_edges_and_their_noise() {
    let few = construct(vec![rounds("s", 314)], &Options { incorrect_rate: 0.05, ..options() }).unwrap();
    let many = construct(vec![rounds("s", 314)], &Options { incorrect_rate: 0.5, ..options() }).unwrap();
    let measured = |graph: &PoseGraph| -> Vec<Vec<f64>> {
        let correct = graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.truth_correct() == Some(true));
        correct.map(|edge| edge.measurement.clone().unwrap()).collect()
    };
    assert_eq!(measured(&few), measured(&many));
    let (first, all) = (landmarks(&few, false), landmarks(&many, false));
    assert!(first.iter().all(|pair| all.contains(pair)), "more false edges are added to the same ones");
}

#[test]
fn sessions_are_joined_as_they_are() {
    let graph = construct(vec![rounds("s", 100), rounds("t", 100)], &options()).unwrap();
    assert_eq!(graph.sessions(), ["s", "t"]);
    assert_eq!(graph.nodes.len(), 200);
    assert_eq!(graph.edges_of(EdgeKind::Odometry).count(), 198);
    assert_eq!(graph.header.noise_models.len(), 2, "one odometry model for both, and the landmarks'");
    assert!(landmarks(&graph, true).iter().all(|&(from, to)| from < 100 && to >= 100));
}

#[test]
fn noise_models_of_one_name_and_different_content_are_kept_apart() {
    let mut second = rounds("t", 100);
    second.header.noise_models[0].1.information[0] = 7.0;
    let graph = construct(vec![rounds("s", 100), second], &options()).unwrap();
    let odometry: Vec<&posecut_graph::Edge> = graph.edges_of(EdgeKind::Odometry).collect();
    assert_eq!(graph.information(odometry[0]).unwrap()[0], 100.0);
    assert_eq!(graph.information(odometry[150]).unwrap()[0], 7.0);
}

#[test]
fn a_minimum_interval_leaves_out_neighbours_across_the_cut() {
    let plain = construct(vec![rounds("s", 314)], &options()).unwrap();
    let apart = construct(vec![rounds("s", 314)], &Options { minimum_interval: 60.0, ..options() }).unwrap();
    assert!(landmarks(&plain, true).contains(&(156, 157)));
    assert!(!landmarks(&apart, true).contains(&(156, 157)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn incorrect_edges_make_the_asked_share_and_are_far_apart(rate in 0.0_f64..0.9, seed in 0_u64..1000) {
        let graph = construct(vec![rounds("s", 314)], &Options { incorrect_rate: rate, seed, ..options() }).unwrap();
        let (correct, incorrect) = (landmarks(&graph, true), landmarks(&graph, false));
        let share = incorrect.len() as f64 / (correct.len() + incorrect.len()) as f64;
        prop_assert!((share - rate).abs() <= 0.5 / correct.len() as f64 + 1e-12, "{} against {}", share, rate);
        let distinct: BTreeSet<_> = incorrect.iter().collect();
        prop_assert_eq!(distinct.len(), incorrect.len());
        for &(from, to) in &incorrect {
            prop_assert!((truth(&graph, from).translation - truth(&graph, to).translation).norm() > 10.0);
            prop_assert!(from < 157 && to >= 157, "they join the two experiences");
        }
        let again = construct(vec![rounds("s", 314)], &Options { incorrect_rate: rate, seed, ..options() }).unwrap();
        prop_assert_eq!(graph, again);
    }

    #[test]
    fn measurement_noise_has_the_stated_size(seed in 0_u64..50) {
        let graph = construct(vec![rounds("s", 314)], &Options { seed, ..options() }).unwrap();
        let errors: Vec<[f64; 3]> = graph
            .edges_of(EdgeKind::Landmark)
            .filter(|edge| edge.truth_correct() == Some(true))
            .map(|edge| {
                let measured = SE2::from_components(edge.measurement.as_ref().unwrap()).unwrap();
                truth(&graph, edge.from).between(&truth(&graph, edge.to)).between(&measured).log().into()
            })
            .collect();
        for (axis, sigma) in [(0, 0.1), (1, 0.1), (2, 0.02)] {
            let deviation = (errors.iter().map(|error| error[axis].powi(2)).sum::<f64>() / errors.len() as f64).sqrt();
            // With several hundred edges, five standard errors are about a fifth.
            prop_assert!((deviation / sigma - 1.0).abs() < 0.2, "axis {}: {} against {}", axis, deviation, sigma);
        }
    }
}

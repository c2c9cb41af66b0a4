//! Properties of each kind of incorrect edges.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};

use posecut_construct::{IncorrectKind, Options};
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{Edge, EdgeKind, PoseGraph};
use proptest::prelude::*;

use crate::rounds::{construct, landmarks, options, rounds, truth};

fn with(kind: IncorrectKind, rate: f64, seed: u64) -> PoseGraph {
    let options = Options { incorrect_kind: kind, incorrect_rate: rate, seed, ..options() };
    construct(vec![rounds("s", 314)], &options).unwrap()
}

fn wrong(graph: &PoseGraph) -> impl Iterator<Item = &Edge> {
    graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.truth_correct() == Some(false))
}

fn claim(edge: &Edge) -> SE2 {
    SE2::from_components(edge.measurement.as_ref().unwrap()).unwrap()
}

/// Incorrect edges by the mistake that made them.
fn groups(graph: &PoseGraph) -> BTreeMap<u64, Vec<&Edge>> {
    let mut groups: BTreeMap<u64, Vec<&Edge>> = BTreeMap::new();
    for edge in wrong(graph) {
        let group = edge.truth.as_ref().unwrap().extra["group"].as_u64().unwrap();
        groups.entry(group).or_default().push(edge);
    }
    groups
}

/// Share of incorrect edges that have an incorrect support edge (delta 1).
fn supported(graph: &PoseGraph) -> f64 {
    let ends: BTreeSet<(u64, u64)> = landmarks(graph, false).into_iter().collect();
    let near = |(from, to): (u64, u64)| {
        ends.iter().any(|&(i, j)| (i, j) != (from, to) && i.abs_diff(from) <= 1 && j.abs_diff(to) <= 1)
    };
    ends.iter().filter(|&&pair| near(pair)).count() as f64 / ends.len() as f64
}

#[test]
fn grouped_mistakes_support_each_other_and_uniform_ones_do_not() {
    let graph = with(IncorrectKind::Grouped, 0.1, 1);
    assert!(supported(&graph) > 0.95, "{}", supported(&graph));
    let uniform = supported(&with(IncorrectKind::Uniform, 0.1, 1));
    assert!(uniform < 0.2, "{uniform}");
    for members in groups(&graph).values() {
        assert!(
            members.windows(2).all(|pair| (pair[0].from + 1, pair[0].to + 1) == (pair[1].from, pair[1].to))
        );
        for edge in members {
            let differs = claim(members[0]).between(&claim(edge));
            assert!(differs.translation.norm() < 1.0 && differs.angle().abs() < 0.2, "one claim, with noise");
        }
    }
}

#[test]
fn the_stretches_have_the_length_asked_for() {
    let asked =
        Options { incorrect_kind: IncorrectKind::Grouped, group_length: 4, incorrect_rate: 0.2, ..options() };
    let graph = construct(vec![rounds("s", 314)], &asked).unwrap();
    let lengths: Vec<usize> = groups(&graph).values().map(Vec::len).collect();
    let (last, full) = lengths.split_last().unwrap();
    assert!(full.len() > 5 && full.iter().all(|&length| length == 4) && *last <= 4, "{lengths:?}");
}

#[test]
fn edges_of_one_corridor_claim_one_alignment() {
    let graph = with(IncorrectKind::Corridor, 0.2, 3);
    let groups = groups(&graph);
    for members in groups.values() {
        // The position at which the claim puts the later experience: the same for all edges, except for the noise of
        // the edge. Its 0.02 rad move a viewpoint 100 m from the origin by metres.
        let displacement = |edge: &&Edge| {
            let claimed = truth(&graph, edge.from).compose(&claim(edge));
            truth(&graph, edge.to).translation - claimed.translation
        };
        let first = displacement(&members[0]);
        assert!(first.norm() > 9.0 && first.norm() < 41.0, "{first}");
        for edge in members {
            assert!((displacement(edge) - first).norm() < 1.0, "{} against {first}", displacement(edge));
        }
    }
    assert!(groups.values().any(|members| members.len() > 5));
}

#[test]
fn near_misses_are_near_and_miss() {
    let graph = with(IncorrectKind::NearMiss, 0.3, 2);
    let correct: BTreeSet<(u64, u64)> = landmarks(&graph, true).into_iter().collect();
    for edge in wrong(&graph) {
        let true_pose = truth(&graph, edge.from).between(&truth(&graph, edge.to));
        assert!(true_pose.translation.norm() <= 10.0 && true_pose.angle().abs() <= 90_f64.to_radians());
        assert!(!correct.contains(&(edge.from, edge.to)));
        let error = true_pose.between(&claim(edge));
        assert!(error.translation.norm() > 3.0 || error.angle().abs() > 30_f64.to_radians(), "{error:?}");
    }
}

#[test]
fn more_near_misses_than_there_are_pairs_are_refused() {
    let asked = Options {
        incorrect_kind: IncorrectKind::NearMiss,
        incorrect_rate: 0.95,
        incorrect_distance: 4.0,
        ..options()
    };
    let error = construct(vec![rounds("s", 314)], &asked).unwrap_err().to_string();
    assert!(
        error.contains("157 of 8949")
            && error.contains("near-miss")
            && error.contains("decrease --incorrect-rate"),
        "{error}"
    );
}

#[test]
fn a_group_of_one_is_refused() {
    let asked = Options { group_length: 1, ..options() };
    let error = construct(vec![rounds("s", 314)], &asked).unwrap_err().to_string();
    assert!(error.starts_with("--group-length is 1"), "{error}");
}

/// A rotation drawn with a deviation of 1e300 was not a number, and the writer reported it as an error of the stage.
#[test]
fn deviations_whose_squares_are_no_numbers_are_refused() {
    for value in [1e300, 1e-300] {
        let asked = [
            Options { landmark_sigma_translation: value, ..options() },
            Options { landmark_sigma_rotation: value, ..options() },
            Options { landmark_covariance_scale: value, ..options() },
        ];
        for asked in asked {
            let error = construct(vec![rounds("s", 314)], &asked).unwrap_err().to_string();
            assert!(error.starts_with("--landmark-") && error.contains("from 1e-50 to 1e50"), "{error}");
        }
    }
    let largest = Options { landmark_sigma_rotation: 1e50, opposite_direction: true, ..options() };
    let graph = construct(vec![rounds("s", 314)], &largest).unwrap();
    graph.write(&mut Vec::new()).unwrap();
}

fn kind() -> impl Strategy<Value = IncorrectKind> {
    prop_oneof![
        Just(IncorrectKind::Uniform),
        Just(IncorrectKind::Grouped),
        Just(IncorrectKind::NearMiss),
        Just(IncorrectKind::Corridor)
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn every_kind_makes_the_asked_share_of_different_pairs(kind in kind(), rate in 0.0_f64..0.5, seed in 0_u64..1000) {
        let graph = with(kind, rate, seed);
        let (correct, incorrect) = (landmarks(&graph, true), landmarks(&graph, false));
        let share = incorrect.len() as f64 / (correct.len() + incorrect.len()) as f64;
        prop_assert!((share - rate).abs() <= 0.5 / correct.len() as f64 + 1e-12);
        let distinct: BTreeSet<_> = incorrect.iter().collect();
        prop_assert_eq!(distinct.len(), incorrect.len());
        prop_assert!(incorrect.iter().all(|&(from, to)| from < 157 && to >= 157));
        let distances = incorrect.iter().map(|&(from, to)| (truth(&graph, from).translation - truth(&graph, to).translation).norm());
        prop_assert!(distances.into_iter().all(|metres| (metres > 10.0) == (kind != IncorrectKind::NearMiss)));
        prop_assert_eq!(&graph, &with(kind, rate, seed));
        prop_assert_eq!(correct, landmarks(&with(IncorrectKind::Uniform, 0.0, seed), true));
    }
}

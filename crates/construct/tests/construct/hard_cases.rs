//! Graphs as users have them: few correct edges or none, interrupted odometry, noise that differs from the stated one.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::{BTreeMap, BTreeSet};

use posecut_construct::{IncorrectKind, NoiseKind, Options};
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{EdgeKind, PoseGraph};
use proptest::prelude::*;

use crate::rounds::{construct, landmarks, options, rounds, there_and_back, truth};

fn built(options: &Options) -> PoseGraph {
    construct(vec![rounds("s", 314)], options).unwrap()
}

fn refusal(options: &Options) -> String {
    construct(vec![rounds("s", 314)], options).unwrap_err().to_string()
}

/// Errors of the correct edges in units of the stated standard deviations.
fn errors(graph: &PoseGraph) -> Vec<[f64; 3]> {
    graph
        .edges_of(EdgeKind::Landmark)
        .filter(|edge| edge.truth_correct() == Some(true))
        .map(|edge| {
            let measured = SE2::from_components(edge.measurement.as_ref().unwrap()).unwrap();
            let error = truth(graph, edge.from).between(&truth(graph, edge.to)).between(&measured).log();
            [error[0] / 0.1, error[1] / 0.1, error[2] / 0.02]
        })
        .collect()
}

#[test]
fn as_many_correct_edges_are_kept_as_asked_for() {
    let all: BTreeSet<_> = landmarks(&built(&options()), true).into_iter().collect();
    let twelve = built(&Options { correct_edges: Some(12), incorrect_rate: 0.25, ..options() });
    let kept = landmarks(&twelve, true);
    assert_eq!((kept.len(), landmarks(&twelve, false).len()), (12, 4), "the rate is a share of what is kept");
    assert!(kept.iter().all(|pair| all.contains(pair)));
    let twenty = landmarks(&built(&Options { correct_edges: Some(20), ..options() }), true);
    assert!(kept.iter().all(|pair| twenty.contains(pair)), "more edges are added to the same ones");
    let other = landmarks(&built(&Options { correct_edges: Some(12), seed: 2, ..options() }), true);
    assert_ne!(kept, other, "drawn at random");
}

#[test]
fn more_correct_edges_than_similar_pairs_are_refused() {
    let error = refusal(&Options { correct_edges: Some(100_000), ..options() });
    assert!(
        error.contains("is 100000, but the sessions give only 471") && error.contains("decrease it"),
        "{error}"
    );
    assert!(refusal(&Options { correct_edges: Some(0), ..options() }).contains("--no-correct-edges"));
    let both = Options { correct_edges: Some(3), no_correct_edges: true, ..options() };
    assert!(refusal(&both).starts_with("--correct-edges is 3"));
}

#[test]
fn without_correct_edges_the_incorrect_ones_stay_as_they_were() {
    for kind in [IncorrectKind::Uniform, IncorrectKind::Grouped, IncorrectKind::NearMiss] {
        let usual = Options { incorrect_kind: kind, incorrect_rate: 0.3, ..options() };
        let (with, without) = (built(&usual), built(&Options { no_correct_edges: true, ..usual }));
        assert!(landmarks(&without, true).is_empty());
        assert!(!landmarks(&without, false).is_empty());
        let measured = |graph: &PoseGraph| -> Vec<Vec<f64>> {
            let wrong = graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.truth_correct() == Some(false));
            wrong.map(|edge| edge.measurement.clone().unwrap()).collect()
        };
        assert_eq!(landmarks(&with, false), landmarks(&without, false));
        assert_eq!(measured(&with), measured(&without));
    }
}

#[test]
fn heavy_tails_are_those_of_students_t() {
    let share = |noise: NoiseKind, limit: f64| {
        let (mut beyond, mut count) = (0.0, 0.0);
        for seed in 1..=8 {
            for error in errors(&built(&Options { noise, seed, ..options() })).as_flattened() {
                beyond += f64::from(error.abs() > limit);
                count += 1.0;
            }
        }
        beyond / count
    };
    // Quantiles of t with 3 degrees of freedom: 3.182 at 0.975, 5.841 at 0.995; of the normal: 1.960 at 0.975. There
    // are about 11 000 errors, of which the three of an edge are not independent.
    assert!((share(NoiseKind::StudentT, 3.182) - 0.05).abs() < 0.01);
    assert!((share(NoiseKind::StudentT, 5.841) - 0.01).abs() < 0.005);
    assert!((share(NoiseKind::Gaussian, 1.960) - 0.05).abs() < 0.01);
}

#[test]
fn one_stretch_of_the_tails_serves_all_axes_of_an_edge() {
    let mut both = [[0.0; 2]; 2];
    for seed in 1..=8 {
        for error in errors(&built(&Options { noise: NoiseKind::StudentT, seed, ..options() })) {
            both[usize::from(error[0].abs() > 3.182)][usize::from(error[1].abs() > 3.182)] += 1.0;
        }
    }
    let beyond_given = |row: [f64; 2]| row[1] / (row[0] + row[1]);
    assert!(beyond_given(both[1]) > 4.0 * beyond_given(both[0]), "{both:?}");
}

#[test]
fn the_claimed_covariance_is_a_multiple_of_the_noise() {
    let (usual, wide) = (built(&options()), built(&Options { landmark_covariance_scale: 10.0, ..options() }));
    assert_eq!(errors(&usual), errors(&wide), "the noise is as it was");
    let information = |graph: &PoseGraph| -> Vec<f64> {
        let edge = graph.edges_of(EdgeKind::Landmark).next().unwrap();
        graph.information(edge).unwrap().to_vec()
    };
    for (usual, wide) in information(&usual).iter().zip(information(&wide)) {
        assert!((usual - 10.0 * wide).abs() <= 1e-9 * usual, "{usual} against {wide}");
    }
    for scale in [0.0, -1.0, f64::NAN] {
        let error = refusal(&Options { landmark_covariance_scale: scale, ..options() });
        assert!(error.starts_with("--landmark-covariance-scale is"), "{error}");
    }
}

#[test]
fn places_seen_from_the_other_side_are_correct_edges_where_asked_for() {
    let graphs = || vec![there_and_back("s", 200)];
    let error = construct(graphs(), &Options { minimum_interval: 9.0, ..options() }).unwrap_err().to_string();
    assert!(error.starts_with("no two viewpoints"), "{error}");
    let asked = Options { minimum_interval: 9.0, opposite_direction: true, ..options() };
    let graph = construct(graphs(), &asked).unwrap();
    let right = landmarks(&graph, true);
    assert!(right.len() > 90, "{}", right.len());
    for (from, to) in right {
        let between = truth(&graph, from).between(&truth(&graph, to));
        assert!(between.translation.norm() <= 3.0 && between.angle().abs() >= 150_f64.to_radians());
    }
    assert!(
        errors(&graph).iter().all(|error| error.iter().all(|deviations| deviations.abs() < 6.0)),
        "measured as they are"
    );
}

#[test]
fn opposite_viewpoints_are_added_to_the_usual_ones() {
    let both = built(&Options { opposite_direction: true, ..options() });
    assert_eq!(landmarks(&both, true), landmarks(&built(&options()), true), "nobody drives back on the ring");
}

/// The sizes of the chains, by their first node.
fn chains(graph: &PoseGraph) -> BTreeMap<usize, usize> {
    let mut first: Vec<usize> = (0..graph.nodes.len()).collect();
    for edge in graph.edges_of(EdgeKind::Odometry) {
        // Odometry joins each node to the next, so the first node of the chain is already known.
        let (from, to) = (graph.node_index(edge.from).unwrap(), graph.node_index(edge.to).unwrap());
        first[to] = first[from];
    }
    let mut sizes = BTreeMap::new();
    for node in first {
        *sizes.entry(node).or_insert(0) += 1;
    }
    sizes
}

#[test]
fn more_gaps_than_odometry_edges_are_refused() {
    let error = refusal(&Options { odometry_gaps: 313, ..options() });
    assert!(
        error.contains("--odometry-gaps is 313")
            && error.contains("at most 312, the number of odometry edges"),
        "{error}"
    );
    let none = built(&Options { odometry_gaps: 312, ..options() });
    assert_eq!(none.edges_of(EdgeKind::Odometry).count(), 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn gaps_make_chains_and_isolate_no_node_without_need(gaps in 1_usize..100, seed in 0_u64..1000) {
        let graph = built(&Options { odometry_gaps: gaps, seed, ..options() });
        prop_assert_eq!(graph.edges_of(EdgeKind::Odometry).count(), 312 - gaps);
        let chains = chains(&graph);
        prop_assert_eq!(chains.len(), 2 + gaps);
        prop_assert!(chains.values().all(|&size| size >= 2), "{:?}", chains);
        for &start in chains.keys() {
            prop_assert_eq!(graph.nodes[start].pose.as_deref().unwrap(), &[0.0, 0.0, 0.0][..], "a chain starts anew");
        }
        let usual = built(&Options { seed, ..options() });
        for edge in graph.edges_of(EdgeKind::Odometry) {
            let step = |graph: &PoseGraph| {
                let pose = |id| {
                    SE2::from_components(graph.nodes[graph.node_index(id).unwrap()].pose.as_ref().unwrap()).unwrap()
                };
                pose(edge.from).between(&pose(edge.to))
            };
            let difference = step(&graph).between(&step(&usual)).log().norm();
            prop_assert!(difference < 1e-9, "within a chain nothing changes, but {} does", difference);
        }
        let ids: Vec<u64> = graph.edges.iter().map(|edge| edge.id).collect();
        prop_assert_eq!(ids, (0..graph.edges.len() as u64).collect::<Vec<_>>());
        prop_assert_eq!(landmarks(&graph, true), landmarks(&built(&Options { seed, ..options() }), true));
    }
}

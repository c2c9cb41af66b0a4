//! The densest clique compared with all cliques of small graphs, and on planted cliques.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use posecut_densest::{Affinity, densest_clique};
use posecut_stage::random;
use proptest::prelude::*;

fn affinity(count: usize, weights: &[Option<f64>]) -> Affinity {
    Affinity::new(count, |a, b| weights[a * count + b])
}

/// The largest eigenvalue of a clique's weights by plain power iteration on a dense matrix.
fn spectral_radius(affinity: &Affinity, clique: &[usize]) -> f64 {
    let entry = |a: usize, b: usize| if a == b { 1.0 } else { affinity.weight(a, b).unwrap() };
    let mut vector = vec![1.0; clique.len()];
    let mut length = 1.0;
    for _ in 0..1000 {
        let next: Vec<f64> = clique
            .iter()
            .map(|&a| clique.iter().zip(&vector).map(|(&b, share)| entry(a, b) * share).sum())
            .collect();
        length = next.iter().map(|share| share * share).sum::<f64>().sqrt();
        vector = next.iter().map(|share| share / length).collect();
    }
    length
}

fn is_clique(affinity: &Affinity, members: &[usize]) -> bool {
    members
        .iter()
        .enumerate()
        .all(|(place, &a)| members[place + 1..].iter().all(|&b| affinity.weight(a, b).is_some()))
}

/// The largest density of any clique.
fn enumerate(affinity: &Affinity) -> f64 {
    (1_u32..1 << affinity.len())
        .map(|subset| (0..affinity.len()).filter(|vertex| subset >> vertex & 1 == 1).collect::<Vec<_>>())
        .filter(|members| is_clique(affinity, members))
        .map(|members| spectral_radius(affinity, &members))
        .fold(0.0, f64::max)
}

fn weights(count: usize, density: f64, draws: &[(f64, f64)]) -> Vec<Option<f64>> {
    (0..count * count).map(|place| (draws[place].0 < density).then_some(draws[place].1)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    #[test]
    fn the_answer_is_a_maximal_clique_with_the_density_it_claims(
        count in 1_usize..=8,
        density in 0.0_f64..1.0,
        draws in proptest::collection::vec((0.0_f64..1.0, 0.01_f64..1.0), 64),
        seed in 0_u64..100,
    ) {
        let affinity = affinity(count, &weights(count, density, &draws));
        let found = densest_clique(&affinity, 8, &mut random(seed, "test"));
        prop_assert!(is_clique(&affinity, &found.vertices));
        let more = (0..count).any(|vertex| {
            !found.vertices.contains(&vertex)
                && found.vertices.iter().all(|&member| affinity.weight(vertex, member).is_some())
        });
        prop_assert!(!more, "a vertex more would be denser");
        let radius = spectral_radius(&affinity, &found.vertices);
        prop_assert!((found.density - radius).abs() < 1e-6, "{} {radius}", found.density);
        let best = enumerate(&affinity);
        prop_assert!(found.density < best + 1e-6);
        // This is a heuristic, but on graphs this small eight ascents must not miss by much.
        prop_assert!(found.density > 0.9 * best, "{} of {best}", found.density);
        prop_assert!(is_clique(&affinity, &found.rounded()) && found.rounded().len() <= found.vertices.len());
    }
}

#[test]
fn nearly_all_small_graphs_are_solved_to_the_optimum() {
    use posecut_stage::rand::RngExt as _;
    let mut draw = random(3, "graphs");
    let mut optimal = 0;
    for _ in 0..100 {
        let draws: Vec<(f64, f64)> =
            (0..81).map(|_| (draw.random_range(0.0..1.0), draw.random_range(0.01..1.0))).collect();
        let affinity = affinity(9, &weights(9, 0.6, &draws));
        let found = densest_clique(&affinity, 8, &mut random(1, "test"));
        optimal += usize::from(found.density > enumerate(&affinity) - 1e-6);
    }
    assert!(optimal >= 95, "{optimal} of 100");
}

#[test]
fn with_equal_weights_a_planted_largest_clique_is_found_and_its_density_is_its_size() {
    for seed in 0..10_usize {
        // 40 of 120 vertices form a clique; other pairs are consistent now and then.
        let noise = |a: usize, b: usize| (a * 7919 + b * 104_729 + seed * 31).is_multiple_of(10);
        let affinity = Affinity::new(120, |a, b| ((a % 3 == 0 && b % 3 == 0) || noise(a, b)).then_some(1.0));
        let found = densest_clique(&affinity, 1, &mut random(1, "test"));
        let planted: Vec<usize> = (0..120).step_by(3).collect();
        assert!(planted.iter().all(|vertex| found.vertices.contains(vertex)), "{:?}", found.vertices);
        assert!((found.density - found.vertices.len() as f64).abs() < 1e-9);
        assert_eq!(found.rounded(), found.vertices);
    }
}

#[test]
fn a_small_set_that_agrees_well_is_denser_than_a_large_one_that_hardly_does() {
    // Five vertices of weight 0.9 (density 4.6) and eight of weight 0.3 (density 3.1): PCM would take the eight.
    let affinity = Affinity::new(13, |a, b| match (a < 5, b < 5) {
        (true, true) => Some(0.9),
        (false, false) => Some(0.3),
        _ => None,
    });
    let found = densest_clique(&affinity, 1, &mut random(1, "test"));
    assert_eq!(found.vertices, [0, 1, 2, 3, 4]);
    // 1 + 4 x 0.9, in single precision as weights are kept.
    assert!((found.density - (1.0 + 4.0 * f64::from(0.9_f32))).abs() < 1e-9);
    assert_eq!(found.rounded().len(), 5);
}

#[test]
fn graphs_without_vertices_or_pairs_have_an_answer() {
    assert!(densest_clique(&affinity(0, &[]), 3, &mut random(1, "test")).vertices.is_empty());
    let lone = densest_clique(&affinity(3, &[None; 9]), 3, &mut random(1, "test"));
    assert_eq!((lone.vertices.len(), lone.density), (1, 1.0));
}

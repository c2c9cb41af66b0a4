//! Graduation on worlds with many groups of false edges, whose given poses are the truth.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "functions of tests may panic and print")]

use posecut_geometry::SE2;
use posecut_optimize::{Graduated, Options, Problem, Solution, optimize};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::worlds::{add_false_closures, manhattan};

/// Standard deviations.
const WIDTH: f64 = 3.368;

fn graduated(groups: usize, seed: u64, graduation: Graduated) -> Solution<SE2> {
    let random = &mut ChaCha8Rng::seed_from_u64(seed);
    let mut graph = manhattan(300, random);
    add_false_closures(&mut graph, groups, random);
    let problem = Problem::new(graph.0, graph.1).unwrap();
    optimize(&problem, &Options { graduated: Some(graduation), ..Options::default() })
}

/// With squared residuals s and width c, Geman-McClure's cost `s c^2 / (c^2 + s)` is nowhere above `min(s, c^2)`, and so neither is its
/// minimum. Its own surrogates end above it in four of these worlds.
#[test]
fn geman_mcclure_ends_no_higher_than_truncated_least_squares() {
    for (groups, seeds) in [(10, 1..=5), (40, 1..=5)] {
        for seed in seeds {
            let truncated = graduated(groups, seed, Graduated::TruncatedLeastSquares(WIDTH)).cost;
            let smooth = graduated(groups, seed, Graduated::GemanMcClure(WIDTH)).cost;
            println!("{groups} {seed}: {truncated:.3} {smooth:.3}");
            assert!(smooth <= truncated, "{groups} groups, seed {seed}: {smooth}, but truncated {truncated}");
        }
    }
}

/// So many false edges hide the truth from the minimum of all edges.
#[test]
fn graduation_never_ends_above_the_given_poses() {
    for (groups, seed) in [(100, 1), (200, 1)] {
        let found = graduated(groups, seed, Graduated::GemanMcClure(WIDTH));
        let given = found.components[0].cost_given;
        println!("{groups} {seed}: {:?} {:.3}, given {given:.3}", found.components[0].start, found.cost);
        assert!(found.cost <= given, "{groups} groups, seed {seed}: {} above {given}", found.cost);
    }
}

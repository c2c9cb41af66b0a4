//! Descents in which the curvature of large residuals nearly cancels the Gauss-Newton matrix.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "functions of tests may panic and print")]

use posecut_geometry::SE2;
use posecut_optimize::{Initialisation, Options, Problem, optimize};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::worlds::{add_false_closures, manhattan};

/// Gauss-Newton steps alone take 131 to 200 factorisations from the relaxation, and end at the limit in the first and second world.
#[test]
fn regression_descents_with_false_edges_end_within_sixty_factorisations() {
    for (poses, groups, seed) in [(300, 10, 3), (500, 20, 2), (500, 20, 5), (1000, 30, 3)] {
        let random = &mut ChaCha8Rng::seed_from_u64(seed);
        let mut graph = manhattan(poses, random);
        add_false_closures(&mut graph, groups, random);
        let problem = Problem::<SE2, 3>::new(graph.0, graph.1).unwrap();
        let options = Options { initialisation: Initialisation::Chordal, ..Options::default() };
        let found = optimize(&problem, &options);
        let factorizations = found.components[0].factorizations;
        println!("{poses} {groups} {seed}: cost {:.6}, {factorizations} factorisations", found.cost);
        assert!(found.converged && factorizations <= 60, "{poses} {groups} {seed}: {factorizations}");
    }
}

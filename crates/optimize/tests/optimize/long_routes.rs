//! Long, weakly held routes converge.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "functions of tests may panic and print")]

use posecut_optimize::{Initialisation, Options, Problem, optimize};
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;

use crate::worlds::long_route;

/// From the relaxation and from the truth, to the same cost.
#[test]
fn long_routes_with_few_closures_converge_within_fifty_factorisations() {
    for (poses, closures, seed) in
        [(2000, 20, 1), (2000, 20, 2), (5000, 40, 1), (5000, 40, 2), (15_000, 60, 1)]
    {
        let (truth, edges) = long_route(poses, closures, &mut ChaCha8Rng::seed_from_u64(seed));
        let problem = Problem::new(truth, edges).unwrap();
        let solve = |initialisation| optimize(&problem, &Options { initialisation, ..Options::default() });
        let (relaxed, given) = (solve(Initialisation::Chordal), solve(Initialisation::Given));
        let counts = [&relaxed, &given].map(|solution| solution.components[0].factorizations);
        println!("{poses} {closures} {seed}: {} {} {counts:?}", relaxed.cost, given.cost);
        assert!(relaxed.converged && given.converged);
        assert!((relaxed.cost - given.cost).abs() <= 1e-9 * given.cost);
        assert!(counts.iter().all(|&count| count <= 50), "{counts:?}");
    }
}

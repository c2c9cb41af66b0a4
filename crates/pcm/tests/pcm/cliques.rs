//! The maximum clique compared with a plain recursion without bounds or kernels, and the effect of limits.

use std::time::{Duration, Instant};

use posecut_geometry::SE2;
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::clique::{BitGraph, Limits, maximum_clique};
use posecut_pcm::consistency::Pairs;
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_pcm::{Gate, Test};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// The size of the largest clique among `candidates`, by taking or leaving one after the other.
fn plain(graph: &BitGraph, candidates: &[usize], least: usize) -> usize {
    let Some((&first, rest)) = candidates.split_first() else { return 0 };
    if candidates.len() <= least {
        return 0;
    }
    let neighbours: Vec<usize> =
        rest.iter().copied().filter(|&other| graph.connected(first, other)).collect();
    let with = 1 + plain(graph, &neighbours, least.saturating_sub(1));
    with.max(plain(graph, rest, least.max(with)))
}

/// A graph in which every edge has the same probability.
fn uniform(vertices: usize, density: f64, seed: u64) -> BitGraph {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut graph = BitGraph::new(vertices);
    for one in 0..vertices {
        for other in one + 1..vertices {
            if random.random_bool(density) {
                graph.connect(one, other);
            }
        }
    }
    graph
}

/// Vertices in a square, connected if near, like true candidates with similar errors. A share of the vertices lies in a
/// square ten times as wide.
fn geometric(vertices: usize, reach: f64, outliers: f64, seed: u64) -> BitGraph {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let places: Vec<[f64; 2]> = (0..vertices)
        .map(|_| {
            let width = if random.random_bool(outliers) { 10.0 } else { 1.0 };
            [random.random_range(0.0..width), random.random_range(0.0..width)]
        })
        .collect();
    let mut graph = BitGraph::new(vertices);
    for one in 0..vertices {
        for other in one + 1..vertices {
            let [x, y] = [0, 1].map(|axis: usize| places[one][axis] - places[other][axis]);
            if x.hypot(y) < reach {
                graph.connect(one, other);
            }
        }
    }
    graph
}

fn agrees(graph: &BitGraph) -> Result<(), TestCaseError> {
    let found = maximum_clique(graph, Limits::NONE);
    let all: Vec<usize> = (0..graph.len()).collect();
    prop_assert!(graph.is_clique(&found.vertices));
    prop_assert!(found.vertices.is_sorted());
    prop_assert!(found.is_optimal());
    prop_assert_eq!(found.vertices.len(), plain(graph, &all, 0));
    for work in [0, 1, 5] {
        let limited = maximum_clique(graph, Limits::work(work));
        prop_assert!(graph.is_clique(&limited.vertices));
        prop_assert!(limited.vertices.len() <= found.vertices.len());
        prop_assert!(limited.upper_bound >= found.vertices.len(), "a bound below the optimum would be a lie");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]
    #[test]
    fn uniform_graphs(vertices in 1_usize..70, density in 0.1_f64..0.75, seed in any::<u64>()) {
        agrees(&uniform(vertices, density, seed))?;
    }

    #[test]
    fn dense_graphs(vertices in 1_usize..32, density in 0.7_f64..1.0, seed in any::<u64>()) {
        agrees(&uniform(vertices, density, seed))?;
    }

    #[test]
    fn geometric_graphs(
        vertices in 1_usize..32, reach in 0.3_f64..1.4, outliers in 0.0_f64..0.9, seed in any::<u64>(),
    ) {
        agrees(&geometric(vertices, reach, outliers, seed))?;
    }
}

#[test]
fn the_search_itself_is_exercised_and_does_not_depend_on_threads() {
    // Random graphs of this density leave much work to branch and bound.
    let graph = uniform(200, 0.75, 1);
    let solve = |threads: usize, limits: Limits| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| maximum_clique(&graph, limits))
    };
    let one = solve(1, Limits::NONE);
    assert!(one.is_optimal() && one.work > 1000, "{one:?}");
    assert_eq!(one, solve(3, Limits::NONE));
    let limited = solve(1, Limits::work(500));
    assert!(!limited.is_optimal() && limited.upper_bound >= one.vertices.len(), "{limited:?}");
    assert_eq!(limited, solve(3, Limits::work(500)));
}

#[test]
fn a_deadline_that_has_passed_leaves_a_clique_and_a_bound() {
    let graph = uniform(200, 0.75, 2);
    let passed = Instant::now().checked_sub(Duration::from_secs(1)).unwrap();
    let limited = maximum_clique(&graph, Limits { deadline: Some(passed), ..Limits::NONE });
    let exact = maximum_clique(&graph, Limits::NONE);
    assert!(graph.is_clique(&limited.vertices) && !limited.vertices.is_empty());
    assert!(limited.upper_bound >= exact.vertices.len() && limited.upper_bound > limited.vertices.len());
}

/// A branch that does not end took all nodes there were, and the bound was the same afterwards.
#[test]
fn a_stalled_bound_took_all_nodes_of_the_limit() {
    let graph = uniform(300, 0.9, 4);
    let patient = maximum_clique(&graph, Limits::work(100_000));
    let limited = maximum_clique(&graph, Limits { stall: 500, ..Limits::work(100_000) });
    assert!(!patient.is_optimal() && patient.work >= 100_000, "{patient:?}");
    assert!(limited.work < 20_000, "{}", limited.work);
    assert!(
        graph.is_clique(&limited.vertices) && limited.upper_bound > limited.vertices.len(),
        "{limited:?}"
    );
    assert!(limited.upper_bound >= patient.vertices.len());
}

#[test]
fn cliques_of_thousands_are_found_and_proved() {
    let graph = geometric(3000, 1.3, 0.3, 5);
    let found = maximum_clique(&graph, Limits::NONE);
    assert!(found.is_optimal() && found.vertices.len() > 1500, "{}", found.vertices.len());
}

#[test]
fn kernels_of_near_misses_leave_nothing_to_search() {
    let scenario = Scenario { candidates: 5000, outliers: 0.9, falsehood: Falsehood::NearMiss, seed: 2 };
    let drawn = scenario.draw::<SE2, 3>();
    let chains = Chains::<SE2, 3>::of(&drawn).unwrap();
    let grouped = group(&drawn, &chains).unwrap();
    let gate = Gate::new(Test::Mahalanobis, 0.99, 3).unwrap();
    let (graph, _) = Pairs::new(&chains, &grouped.groups[0]).graph(gate);
    let found = maximum_clique(&graph, Limits::work(0));
    assert!(graph.is_clique(&found.vertices) && found.is_optimal(), "{found:?}");
}

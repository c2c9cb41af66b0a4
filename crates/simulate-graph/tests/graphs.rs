//! Simulated graphs: what is drawn, what options fix, and that labels are true.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;

use posecut_geometry::covariance::unpack_upper_triangle;
use posecut_geometry::{LieGroup, SE3};
use posecut_graph::{EdgeKind, PoseGraph, for_dimension};
use posecut_simulate_graph::{Character, Mistake, Options, Simulated, World, simulate};

fn of_seed(seed: u64) -> Options {
    Options { seed, ..Options::default() }
}

fn simulated(options: &Options) -> Simulated {
    simulate(options).unwrap()
}

fn bytes(options: &Options) -> Vec<u8> {
    let mut bytes = Vec::new();
    simulated(options).graph.write(&mut bytes).unwrap();
    bytes
}

/// The errors of edges of one kind against the truth: the tangent vector, whether the edge is correct, and its squared distance.
fn errors<G: LieGroup<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    kind: EdgeKind,
) -> Vec<(Vec<f64>, bool, f64)> {
    let truth = |id: u64| {
        let node = &graph.nodes[graph.node_index(id).unwrap()];
        G::from_components(node.truth.as_ref().unwrap().pose.as_ref().unwrap()).unwrap()
    };
    let of_edge = |edge: &posecut_graph::Edge| {
        let measured = G::from_components(edge.measurement.as_ref().unwrap()).unwrap();
        let error = truth(edge.from).between(&truth(edge.to)).between(&measured).log();
        let information = unpack_upper_triangle::<DOF>(graph.information(edge).unwrap()).unwrap();
        let squared = (error.transpose() * information * error)[0];
        (error.iter().copied().collect(), edge.truth_correct().unwrap_or(true), squared)
    };
    graph.edges_of(kind).map(of_edge).collect()
}

#[test]
fn a_seed_fixes_the_graph_and_another_seed_changes_it() {
    assert_eq!(bytes(&of_seed(3)), bytes(&of_seed(3)));
    assert_ne!(bytes(&of_seed(3)), bytes(&of_seed(4)));
}

#[test]
fn a_written_graph_is_read_as_it_was() {
    for seed in 1..6 {
        let graph = simulated(&of_seed(seed)).graph;
        assert_eq!(PoseGraph::read("simulated", bytes(&of_seed(seed)).as_slice()).unwrap(), graph);
    }
}

#[test]
fn an_option_fixes_its_part_and_nothing_else() {
    let drawn = Character::draw(&of_seed(9));
    let fixed = Character::draw(&Options {
        robots: Some(4),
        poses: Some(70),
        odometry_ratio: Some(5.0),
        incorrect_rate: Some(0.25),
        incorrect_kind: vec![Mistake::Corridor, Mistake::Uniform],
        ..of_seed(9)
    });
    let expected = Character {
        robots: 4,
        poses: 70,
        odometry_ratio: 5.0,
        incorrect_rate: 0.25,
        mistakes: vec![(Mistake::Corridor, 0.5), (Mistake::Uniform, 0.5)],
        ..drawn
    };
    assert_eq!(fixed, expected);
}

#[test]
fn every_world_dimension_and_kind_of_mistake_is_drawn() {
    let all: Vec<Character> = (1..200).map(|seed| Character::draw(&of_seed(seed))).collect();
    let dimensions: BTreeSet<u64> = all.iter().map(|character| character.dimension).collect();
    let worlds: BTreeSet<String> = all.iter().map(|character| format!("{:?}", character.world)).collect();
    let robots: BTreeSet<usize> = all.iter().map(|character| character.robots).collect();
    let kinds: BTreeSet<Mistake> =
        all.iter().flat_map(|character| character.mistakes.iter().map(|(kind, _)| *kind)).collect();
    assert_eq!((dimensions.len(), worlds.len(), robots.len(), kinds.len()), (2, 4, 4, 4));
    for character in &all {
        assert!(character.world != World::Flight || character.dimension == 3);
        let shares: f64 = character.mistakes.iter().map(|(_, share)| share).sum();
        assert!((shares - 1.0).abs() < 1e-12, "{character:?}");
    }
}

#[test]
fn incorrect_edges_are_off_by_more_than_noise_and_correct_ones_are_not() {
    let mut incorrect = 0;
    for seed in 1..40 {
        let Simulated { graph, character, correct_edges, incorrect_edges } = simulated(&of_seed(seed));
        let found =
            for_dimension!(graph.header.dimension, |G, DOF| errors::<G, DOF>(&graph, EdgeKind::Landmark));
        assert_eq!(found.iter().filter(|(_, is_correct, _)| *is_correct).count(), correct_edges);
        assert_eq!(found.len(), correct_edges + incorrect_edges);
        incorrect += incorrect_edges;
        let translations = if character.dimension == 2 { 2 } else { 3 };
        let deviation = character.landmark_ratio * character.landmark_sigma.0;
        let least = f64::max(0.5, 6.0 * character.landmark_ratio.max(1.0) * character.landmark_sigma.0);
        for (error, is_correct, _) in &found {
            let length = error[..translations].iter().map(|along| along * along).sum::<f64>().sqrt();
            // Heavy tails reach far; a wrong edge has noise, too.
            let reach = if character.heavy_tails { 60.0 } else { 7.0 };
            if *is_correct {
                assert!(length < reach * deviation, "seed {seed}: correct, but off by {length} m");
            } else if !character.heavy_tails {
                // The logarithm of a rotated error is longer or shorter than its translation by a bounded factor.
                assert!(
                    length > 0.6 * least - 6.0 * deviation,
                    "seed {seed}: incorrect, but off by {length} m"
                );
            }
        }
    }
    assert!(incorrect > 1000, "{incorrect}");
}

/// The mean squared distance per degree of freedom is the square of the ratio of real to claimed deviations.
#[test]
fn noise_is_as_much_larger_than_claimed_as_the_ratios_say() {
    for dimension in [2, 3] {
        let options = |seed| Options {
            dimension: Some(dimension),
            world: Some(World::Meadow),
            robots: Some(2),
            poses: Some(1500),
            correct_edges: Some(1500),
            incorrect_rate: Some(0.0),
            odometry_ratio: Some(3.0),
            landmark_ratio: Some(0.5),
            ..of_seed(seed)
        };
        let is_normal = |seed: &u64| {
            let character = Character::draw(&options(*seed));
            let coherent = character.odometry_scale + character.odometry_turn + character.slip_rate;
            !character.heavy_tails && coherent == 0.0
        };
        let seed = (1..100).find(is_normal).unwrap();
        let graph = simulated(&options(seed)).graph;
        let mean = |kind| {
            let found = for_dimension!(graph.header.dimension, |G, DOF| errors::<G, DOF>(&graph, kind));
            let freedom = graph.header.dimension.degrees_of_freedom();
            found.iter().map(|(.., squared)| squared).sum::<f64>() / (freedom * found.len()) as f64
        };
        for (kind, expected) in [(EdgeKind::Landmark, 0.25), (EdgeKind::Odometry, 9.0)] {
            let found = mean(kind) / expected;
            assert!((0.9..1.1).contains(&found), "seed {seed}, {kind:?}: {found} of what is expected");
        }
    }
}

#[test]
fn steps_are_a_metre_long_and_robots_are_sessions() {
    for world in [World::Streets, World::Meadow, World::Rounds, World::Flight] {
        let options = Options { dimension: Some(3), world: Some(world), robots: Some(2), ..of_seed(5) };
        let graph = simulated(&options).graph;
        assert_eq!(graph.sessions(), ["robot-1", "robot-2"]);
        let truth: Vec<SE3> = graph
            .nodes
            .iter()
            .map(|node| SE3::from_components(node.truth.as_ref().unwrap().pose.as_ref().unwrap()).unwrap())
            .collect();
        for edge in graph.edges_of(EdgeKind::Odometry) {
            let step = truth[edge.from as usize].between(&truth[edge.to as usize]);
            let length = step.translation.norm();
            // Beside the inner side of a bend, rounds are shorter.
            let range = if world == World::Rounds { 0.5..1.6 } else { 0.9..1.1 };
            assert!(range.contains(&length), "{world:?}: a step of {length} m");
        }
    }
}

#[test]
fn impossible_options_are_refused_in_a_sentence() {
    let refused = [
        (
            Options { incorrect_rate: Some(1.0), ..of_seed(1) },
            "--incorrect-rate is 1, but must be at least 0 and below 1",
        ),
        (Options { incorrect_rate: Some(f64::NAN), ..of_seed(1) }, "--incorrect-rate is NaN, but must be"),
        (
            Options { odometry_ratio: Some(0.0), ..of_seed(1) },
            "--odometry-ratio is 0, but must be between 0.01 and 100",
        ),
        (
            Options { dimension: Some(2), world: Some(World::Flight), ..of_seed(1) },
            "--world is flight, but must be another one in the plane",
        ),
    ];
    let refused = refused.into_iter().chain([(
        Options { robots: Some(1000), poses: Some(1_000_000), ..of_seed(1) },
        "--poses is 1000000 for each of 1000 robots, but must be such that",
    )]);
    for (options, said) in refused {
        let error = simulate(&options).unwrap_err().to_string();
        assert!(error.starts_with(said), "{error}");
    }
}

/// Regression: the three robots of seed 44 saw no place twice, and the benchmark cannot count edges of a graph without any.
#[test]
fn other_paths_are_tried_where_no_place_is_seen_twice() {
    assert!(simulated(&of_seed(44)).correct_edges > 0);
    let lonely = Options { world: Some(World::Flight), poses: Some(50), robots: Some(1), ..of_seed(2) };
    let Simulated { graph, correct_edges, incorrect_edges, .. } = simulated(&lonely);
    assert_eq!(graph.edges_of(EdgeKind::Landmark).count(), correct_edges + incorrect_edges);
    assert!(graph.nodes.len() == 50 && graph.edges_of(EdgeKind::Odometry).count() == 49);
}

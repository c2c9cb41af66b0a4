//! Given poses that miss their edges by no more than noise are the start, but never in a wrong basin of rotations.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "functions of tests may panic and print")]

use nalgebra::{Matrix3, SVector, Vector3};
use posecut_geometry::{LieGroup, SE2};
use posecut_optimize::{Edge, EdgeKind, Initialisation, Options, Problem, Solution, Start, optimize};
use rand::{RngExt, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use crate::worlds::{add_rotation_noise, manhattan};

fn solve(poses: &[SE2], edges: &[Edge<SE2, 3>], initialisation: Initialisation) -> Solution<SE2> {
    let problem = Problem::new(poses.to_vec(), edges.to_vec()).unwrap();
    optimize(&problem, &Options { initialisation, ..Options::default() })
}

fn moved(poses: &[SE2], size: f64, random: &mut ChaCha8Rng) -> Vec<SE2> {
    let mut step = || SE2::exp(&SVector::from_fn(|_, _| random.random_range(-size..size)));
    poses.iter().map(|pose| pose.compose(&step())).collect()
}

/// The same edges with weaker information: every cost is then below the noise that it states.
fn weakened(edges: &[Edge<SE2, 3>]) -> Vec<Edge<SE2, 3>> {
    let weak = |edge: &Edge<SE2, 3>| Edge { information: edge.information * 1e-9, ..*edge };
    edges.iter().map(weak).collect()
}

#[test]
fn near_poses_need_no_relaxation() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let (truth, edges) = manhattan(600, &mut random);
    let relaxed = solve(&truth, &edges, Initialisation::Chordal);
    let again = solve(&moved(&relaxed.poses, 0.002, &mut random), &edges, Initialisation::Best);
    let report = &again.components[0];
    assert_eq!(report.start, Start::Given);
    assert!((again.cost - relaxed.cost).abs() < 1e-9 * relaxed.cost && report.factorizations <= 2);
    // Far poses are not the start.
    let far = solve(&moved(&relaxed.poses, 0.5, &mut random), &edges, Initialisation::Best);
    assert_eq!(far.components[0].start, Start::Chordal);
}

#[test]
fn a_wrong_basin_that_costs_little_is_not_the_start() {
    // A circle with an error, so that its spanning tree costs more than poses that do not turn, which are a local minimum.
    let nodes = 60;
    let turn = (std::f64::consts::TAU + 1.2) / nodes as f64;
    let edge = |node: usize| {
        let (to, step) = ((node + 1) % nodes, SE2::new(1.0, 0.0, turn));
        Edge::new(
            node,
            to,
            step,
            Matrix3::from_diagonal(&Vector3::new(1e-12, 1e-12, 1e-9)),
            EdgeKind::Odometry,
        )
    };
    let ring: Vec<_> = (0..nodes).map(edge).collect();
    for turn in [0.0, -0.5, -turn] {
        let given: Vec<_> = (0..nodes).map(|node| SE2::new(0.0, 0.0, turn * node as f64)).collect();
        let [relaxed, best] =
            [Initialisation::Chordal, Initialisation::Best].map(|start| solve(&given, &ring, start));
        println!("{turn}: {:e} {:e} {:?}", relaxed.cost, best.cost, best.components[0].start);
        assert!(best.cost <= relaxed.cost * (1.0 + 1e-9) && best.components[0].start == Start::Chordal);
    }
}

/// Where a near start is too far to converge in the steps allowed, the relaxation follows.
#[test]
fn a_near_start_that_does_not_converge_gives_way() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let (truth, edges) = manhattan(300, &mut random);
    let best = solve(&truth, &edges, Initialisation::Chordal);
    let given = moved(&best.poses, 0.4, &mut random);
    let problem = Problem::new(given, weakened(&edges)).unwrap();
    let options = Options { max_iterations: 1, ..Options::default() };
    let solution = optimize(&problem, &options);
    assert_eq!(solution.components[0].start, Start::Chordal);
}

/// From the results of descents that began anywhere, wrong minima among them, the best start ends no higher than the relaxation does.
#[test]
fn no_near_start_ends_above_the_relaxation() {
    let (mut near, mut wrong) = (0, 0);
    for seed in 0..120 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (truth, mut edges) = manhattan(150, &mut random);
        add_rotation_noise(&mut edges, [0.0, 0.01, 0.03][seed as usize % 3], &mut random);
        let edges = weakened(&edges);
        let size = [0.3, 1.0, 2.0, 3.1][seed as usize % 4];
        let reached = solve(&moved(&truth, size, &mut random), &edges, Initialisation::Given);
        let relaxed = solve(&truth, &edges, Initialisation::Chordal);
        let best = solve(&reached.poses, &edges, Initialisation::Best);
        near += usize::from(best.components[0].start == Start::Given);
        wrong += usize::from(reached.cost > relaxed.cost * (1.0 + 1e-6));
        assert!(best.cost <= relaxed.cost * (1.0 + 1e-9), "{seed}: {} {}", best.cost, relaxed.cost);
    }
    println!("{near} near starts, {wrong} wrong minima");
    assert!(near >= 20 && wrong >= 20, "{near} {wrong}");
}

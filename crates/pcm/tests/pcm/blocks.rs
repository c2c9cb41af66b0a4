//! Tests of several pairs at once give the results of tests one by one.

use posecut_geometry::{SE2, SE3};
use posecut_graph::{Edge, EdgeKind};
use posecut_pcm::calibration::Scales;
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::consistency::{PairCounts, Pairs};
use posecut_pcm::generate::{Falsehood, Scenario};
use posecut_pcm::{Gate, Spatial, Test};

/// Both sessions as one chain, with loops along it whose stretches share steps of odometry.
fn joined<G: Spatial<DOF>, const DOF: usize>(scenario: &Scenario) -> posecut_graph::PoseGraph {
    let mut graph = scenario.draw::<G, DOF>();
    let count = graph.nodes.len() / 2;
    for node in &mut graph.nodes {
        node.session = Some("a".to_owned());
    }
    let mut add = |kind: EdgeKind, from: usize, to: usize, motion: &G| {
        let mut edge = Edge::new(kind, graph.edges.len() as u64, from as u64, to as u64);
        edge.measurement = Some(motion.components());
        edge.noise = Some(kind.name().to_owned());
        graph.edges.push(edge);
    };
    add(EdgeKind::Odometry, count - 1, count, &G::identity());
    let chain = {
        let mut graph = scenario.draw::<G, DOF>();
        graph.edges.retain(|edge| edge.kind == EdgeKind::Odometry);
        Chains::<G, DOF>::of(&graph).expect("the graph has covariances").chains.swap_remove(0)
    };
    for place in (0..count - 60).step_by(7) {
        add(EdgeKind::Landmark, place, place + 50, &chain.poses[place].between(&chain.poses[place + 50]));
    }
    graph
}

fn compare<G: Spatial<DOF>, const DOF: usize>(graph: &posecut_graph::PoseGraph, scales: Scales) -> usize {
    let mut chains = Chains::<G, DOF>::of(graph).expect("the graph has covariances");
    let mut grouped = group(graph, &chains).expect("the graph has covariances");
    scales.apply(&mut chains, &mut grouped.groups);
    let gate = Gate::new(Test::Mahalanobis, 0.99, DOF).expect("a probability");
    let mut consistent = 0;
    for group in &grouped.groups {
        let pairs = Pairs::new(&chains, group);
        let (matrix, counts) = pairs.graph(gate);
        let mut singly = PairCounts::default();
        for one in 0..pairs.len() {
            for other in one + 1..pairs.len() {
                let agree = pairs.consistent(one, other, gate, &mut singly);
                assert_eq!(matrix.connected(one, other), agree, "{one} {other}");
                assert_eq!(matrix.connected(other, one), agree, "{other} {one}");
            }
        }
        assert_eq!(counts, singly);
        consistent += counts.consistent;
        // Every other candidate, in reverse: a graph of some candidates, in an order of its own.
        let chosen: Vec<usize> = (0..pairs.len()).rev().step_by(2).collect();
        let (some, _) = pairs.graph_of(&chosen, gate);
        for (row, &one) in chosen.iter().enumerate() {
            for (column, &other) in chosen.iter().enumerate() {
                assert_eq!(some.connected(row, column), matrix.connected(one, other), "{one} {other}");
            }
        }
    }
    consistent
}

fn scenario(candidates: usize, seed: u64) -> Scenario {
    Scenario { candidates, outliers: 0.4, falsehood: Falsehood::Uniform, seed }
}

#[test]
fn pairs_between_two_chains() {
    for candidates in [1, 7, 8, 9, 65, 300] {
        let scenario = scenario(candidates, candidates as u64);
        compare::<SE2, 3>(&scenario.draw::<SE2, 3>(), Scales::ONE);
        compare::<SE3, 6>(&scenario.draw::<SE3, 6>(), Scales::ONE);
    }
}

/// With covariances of odometry as large as these, rotations of more than a radian pass the pre-test.
#[test]
fn pairs_across_odometry_that_turns_far() {
    let loose = Scales { odometry: 3000.0, landmark: 1.0 };
    let scenario = scenario(200, 3);
    let (plane, space) = (scenario.draw::<SE2, 3>(), scenario.draw::<SE3, 6>());
    assert!(compare::<SE2, 3>(&plane, loose) > compare::<SE2, 3>(&plane, Scales::ONE));
    assert!(compare::<SE3, 6>(&space, loose) > compare::<SE3, 6>(&space, Scales::ONE));
}

#[test]
fn pairs_within_one_chain() {
    let scenario = scenario(200, 5);
    assert!(compare::<SE2, 3>(&joined::<SE2, 3>(&scenario), Scales::ONE) > 5000);
    assert!(compare::<SE3, 6>(&joined::<SE3, 6>(&scenario), Scales::ONE) > 5000);
}

/// A covariance that is not positive definite is counted, and consistent with nothing.
#[test]
fn pairs_without_a_positive_definite_covariance() {
    let negative = Scales { odometry: -1.0, landmark: 1e-9 };
    let graph = scenario(100, 7).draw::<SE2, 3>();
    assert_eq!(compare::<SE2, 3>(&graph, negative), 0);
}

//! Held nodes: g2o's `FIX`.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use crate::noisy_walk::{apart, bits, disturbed_walk as graph};
use nalgebra::{DMatrix, SMatrix, SVector};
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_optimize::{
    Edge, EdgeKind, Graduated, Initialisation, Kernel, Marginals, Method, Options, PoseGroup, Problem,
    Termination, certify, optimize, residual,
};
use proptest::prelude::*;

/// The gradient of the cost with respect to one pose, by central differences of the residuals.
fn gradient<G: LieGroup<DOF>, const DOF: usize>(
    poses: &[G],
    edges: &[Edge<G, DOF>],
    node: usize,
) -> SVector<f64, DOF> {
    let cost = |axis: usize, offset: f64| {
        let mut tangent = SVector::<f64, DOF>::zeros();
        tangent[axis] = offset;
        let moved = poses[node].compose(&G::exp(&tangent));
        let pose = |index: usize| if index == node { moved } else { poses[index] };
        let edges = edges.iter().filter(|edge| edge.from == node || edge.to == node);
        let error = |edge: &Edge<G, DOF>| {
            let error = residual(&edge.measurement, &pose(edge.from), &pose(edge.to));
            error.dot(&(edge.information * error))
        };
        edges.map(error).sum::<f64>()
    };
    SVector::from_fn(|axis, _| (cost(axis, 1e-5) - cost(axis, -1e-5)) / 2e-5)
}

fn one_held_node_moves_the_solution_rigidly<G: PoseGroup<DOF>, const DOF: usize>(seed: u64, node: usize) {
    let (given, edges) = graph::<G, DOF>(12, 8, seed);
    let free = optimize(&Problem::new(given.clone(), edges.clone()).unwrap(), &Options::default());
    let problem = Problem::new(given.clone(), edges).unwrap().hold([node]).unwrap();
    for initialisation in
        [Initialisation::Given, Initialisation::SpanningTree, Initialisation::Chordal, Initialisation::Best]
    {
        let held = optimize(&problem, &Options { initialisation, ..Options::default() });
        assert!(
            (held.chi_square - free.chi_square).abs() < 1e-9 * free.chi_square,
            "{} {}",
            held.chi_square,
            free.chi_square
        );
        assert_eq!(bits(&held.poses[node]), bits(&given[node]));
        let motion = given[node].compose(&free.poses[node].inverse());
        let moved: Vec<G> = free.poses.iter().map(|pose| motion.compose(pose)).collect();
        assert!(apart(&moved, &held.poses) < 1e-5, "{initialisation:?} {}", apart(&moved, &held.poses));
        assert_eq!((held.components[0].gauge, held.components[0].held), (node, 1));
    }
}

fn several_held_nodes_stay_and_the_others_settle<G: PoseGroup<DOF>, const DOF: usize>(
    seed: u64,
    fixed: &[usize],
) {
    let (given, edges) = graph::<G, DOF>(12, 8, seed);
    let problem = Problem::new(given.clone(), edges.clone()).unwrap().hold(fixed.iter().copied()).unwrap();
    let free = optimize(&Problem::new(given.clone(), edges.clone()).unwrap(), &Options::default());
    // The same with one more node, joined to the held nodes by edges of great weight.
    let prior = |&node: &usize| {
        let information = SMatrix::identity() * 1e9;
        Edge::new(given.len(), node, given[node], information, EdgeKind::Landmark)
    };
    let stiff: Vec<_> = edges.iter().copied().chain(fixed.iter().map(prior)).collect();
    let origin: Vec<G> = given.iter().copied().chain([G::identity()]).collect();
    let stiff = Problem::new(origin, stiff).unwrap().hold([given.len()]).unwrap();
    let options = Options { cost_tolerance: 0.0, ..Options::default() };
    let expected = optimize(&stiff, &options);
    for method in [Method::LevenbergMarquardt, Method::GaussNewton, Method::Dogleg] {
        for initialisation in [Initialisation::Given, Initialisation::SpanningTree, Initialisation::Chordal] {
            let found = optimize(&problem, &Options { method, initialisation, ..Options::default() });
            assert!(found.converged && found.chi_square > free.chi_square, "{method:?} {initialisation:?}");
            for &node in fixed {
                assert_eq!(bits(&found.poses[node]), bits(&given[node]), "{method:?} {initialisation:?}");
            }
            for node in (0..given.len()).filter(|node| !fixed.contains(node)) {
                let gradient = gradient(&found.poses, &edges, node).amax();
                assert!(gradient < 1e-3, "{method:?} {initialisation:?} node {node}: {gradient}");
            }
            let apart = apart(&found.poses, &expected.poses[..given.len()]);
            assert!(apart < 1e-5, "{method:?} {initialisation:?}: {apart} from the stiff graph");
        }
    }
    let all = Problem::new(given.clone(), edges).unwrap().hold(0..given.len()).unwrap();
    let still = optimize(&all, &Options::default());
    assert_eq!(still.components[0].termination, Termination::NothingToDo);
    assert_eq!(still.chi_square.to_bits(), still.chi_square_given.to_bits());
    assert!(still.poses.iter().zip(&given).all(|(found, given)| bits(found) == bits(given)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn held_nodes_are_constants(seed in 0_u64..1000, first in 0_usize..12, second in 0_usize..12) {
        prop_assume!(first != second);
        one_held_node_moves_the_solution_rigidly::<SE2, 3>(seed, first);
        one_held_node_moves_the_solution_rigidly::<SE3, 6>(seed, first);
        several_held_nodes_stay_and_the_others_settle::<SE2, 3>(seed, &[first, second]);
        several_held_nodes_stay_and_the_others_settle::<SE3, 6>(seed, &[first, second]);
    }
}

#[test]
fn kernels_and_graduation_leave_held_nodes_where_they_are() {
    let (given, mut edges) = graph::<SE2, 3>(20, 15, 5);
    edges[25].measurement = SE2::new(30.0, 0.0, 1.0);
    for edge in edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark) {
        edge.kernel = Some(Kernel::GemanMcClure(3.0));
    }
    let problem = Problem::new(given.clone(), edges).unwrap().hold([3, 11]).unwrap();
    let graduated = Some(Graduated::TruncatedLeastSquares(3.368));
    for options in [Options::default(), Options { graduated, ..Options::default() }] {
        let found = optimize(&problem, &options);
        assert!(found.converged && found.weights[25] < 0.01, "{:?}", found.components);
        assert!([3, 11].iter().all(|&node| bits(&found.poses[node]) == bits(&given[node])));
    }
}

#[test]
fn covariances_with_held_nodes_are_conditional_ones() {
    let (given, edges) = graph::<SE3, 6>(10, 8, 7);
    let free = Problem::new(given.clone(), edges.clone()).unwrap().hold([2]).unwrap();
    let held = Problem::new(given.clone(), edges).unwrap().hold([2, 7]).unwrap();
    let mut of_free = Marginals::new(&free, &given, &[]);
    let mut of_held = Marginals::new(&held, &given, &[]);
    for node in [0, 5, 9] {
        let joint = of_free.joint(&[(node, 7)])[0].unwrap();
        let expected =
            joint.first - joint.cross * joint.second.try_inverse().unwrap() * joint.cross.transpose();
        let found = of_held.poses(&[node])[0].unwrap();
        assert!((found - expected).amax() < 1e-9 * expected.amax(), "{node}: {found} {expected}");
        assert!(found.trace() < joint.first.trace());
    }
    let [first, second] = of_held.poses(&[2, 7])[..] else { panic!("two were asked for") };
    assert!(first == Some(SMatrix::zeros()) && second == Some(SMatrix::zeros()));
    let between: DMatrix<f64> =
        DMatrix::from_iterator(6, 6, of_held.relative(&[(2, 7)])[0].unwrap().iter().copied());
    assert!(between.amax() < 1e-15, "{between}");
}

#[test]
fn the_certificate_is_about_graphs_with_one_held_node_at_most() {
    let (given, edges) = graph::<SE2, 3>(12, 8, 9);
    let verdict = |held: &[usize]| {
        let problem = Problem::new(given.clone(), edges.clone()).unwrap().hold(held.iter().copied()).unwrap();
        certify(&problem, &optimize(&problem, &Options::default()).poses)[0].global
    };
    assert!(verdict(&[]) && verdict(&[4]) && !verdict(&[4, 5]));
}

#[test]
fn a_node_that_is_not_there_cannot_be_held() {
    let (given, edges) = graph::<SE2, 3>(5, 2, 13);
    let error = Problem::new(given, edges).unwrap().hold([2, 5]).unwrap_err();
    assert!(error.to_string().contains("node 5 is to be held, but there are 5 nodes"), "{error}");
}

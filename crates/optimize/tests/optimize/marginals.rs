//! Compares covariances with the dense inverse of finite differences, and checks them in the stage's output.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use crate::noisy_walk::noisy_walk;
use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector};
use posecut_geometry::covariance::between_correlated;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_optimize::{
    Edge, EdgeKind, Kernel, Marginals, Options, PoseGroup, Problem, optimize, optimize_with_marginals,
    residual,
};
use proptest::prelude::*;

/// The covariance of all poses but the first, by central differences of the residuals and a dense inverse.
fn dense<G: PoseGroup<DOF>, const DOF: usize>(
    poses: &[G],
    edges: &[Edge<G, DOF>],
    weights: &[f64],
) -> DMatrix<f64> {
    let size = (poses.len() - 1) * DOF;
    let mut matrix = DMatrix::zeros(size, size);
    for (edge, weight) in edges.iter().zip(weights) {
        let mut jacobian = DMatrix::zeros(DOF, size);
        for node in [edge.from, edge.to].into_iter().filter(|&node| node > 0) {
            for axis in 0..DOF {
                let at = |offset: f64| {
                    let mut tangent = SVector::<f64, DOF>::zeros();
                    tangent[axis] = offset;
                    let moved = poses[node].compose(&G::exp(&tangent));
                    let pose = |index| if index == node { moved } else { poses[index] };
                    residual(&edge.measurement, &pose(edge.from), &pose(edge.to))
                };
                let column = (at(1e-5) - at(-1e-5)) / 2e-5;
                jacobian.set_column((node - 1) * DOF + axis, &DVector::from_column_slice(column.as_slice()));
            }
        }
        let information = DMatrix::from_column_slice(DOF, DOF, edge.information.as_slice()) * *weight;
        matrix += jacobian.transpose() * information * &jacobian;
    }
    matrix.cholesky().unwrap().inverse()
}

fn check<G: PoseGroup<DOF>, const DOF: usize>(nodes: usize, landmarks: usize, seed: u64, every: bool) {
    let (start, mut edges) = noisy_walk::<G, DOF>(nodes, landmarks, 0.05, seed);
    for edge in edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark) {
        edge.kernel = Some(Kernel::Cauchy(0.5));
    }
    let problem = Problem::new(start, edges).unwrap();
    let solution = optimize(&problem, &Options::default());
    let expected = dense(&solution.poses, problem.edges(), &solution.weights);
    let block = |a: usize, b: usize| match (a.checked_sub(1), b.checked_sub(1)) {
        (Some(a), Some(b)) => expected.fixed_view::<DOF, DOF>(a * DOF, b * DOF).into_owned(),
        _ => SMatrix::zeros(),
    };
    let mut marginals = Marginals::new(&problem, &solution.poses, &solution.weights);
    let pairs: Vec<_> = if every {
        (0..nodes).flat_map(|a| (0..nodes).map(move |b| (a, b))).collect()
    } else {
        vec![(nodes - 1, 1), (0, nodes / 2), (nodes / 2, nodes / 2)]
    };
    let size = expected.amax();
    let close = |found: SMatrix<f64, DOF, DOF>, expected: SMatrix<f64, DOF, DOF>| {
        assert!((found - expected).amax() < 1e-6 * size, "{found} {expected}");
    };
    for (&(a, b), joint) in pairs.iter().zip(marginals.joint(&pairs)) {
        let joint = joint.unwrap();
        close(joint.first, block(a, a));
        close(joint.cross, block(a, b));
        close(joint.second, block(b, b));
        assert_eq!(joint.first, joint.first.transpose());
    }
    for (&(a, b), relative) in pairs.iter().zip(marginals.relative(&pairs)) {
        let poses = &solution.poses;
        close(
            relative.unwrap(),
            between_correlated(&poses[a], &block(a, a), &poses[b], &block(b, b), &block(a, b)),
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn covariances_are_blocks_of_the_dense_inverse(nodes in 3_usize..30, landmarks in 0_usize..30, seed: u64) {
        let seed = seed / 2;
        check::<SE2, 3>(nodes, landmarks, seed, true);
        check::<SE2, 3>(nodes, landmarks, seed, false);
        check::<SE3, 6>(nodes, landmarks, seed, true);
        check::<SE3, 6>(nodes, landmarks, seed, false);
    }
}

/// Two walks side by side in one problem, with kernels that may give landmark edges the weight zero.
fn two_walks<G: PoseGroup<DOF>, const DOF: usize>(
    nodes: usize,
    kernel: Option<Kernel>,
    seed: u64,
) -> Problem<G, DOF> {
    let (mut poses, mut edges) = noisy_walk::<G, DOF>(nodes, nodes / 2, 0.05, seed);
    let (others, more) = noisy_walk::<G, DOF>(nodes + 30, nodes, 0.05, seed + 1);
    poses.extend(others);
    edges.extend(more.into_iter().map(|edge| Edge { from: edge.from + nodes, to: edge.to + nodes, ..edge }));
    for edge in edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark) {
        edge.kernel = kernel;
    }
    Problem::new(poses, edges).unwrap()
}

/// Marginals that share analysis and memory with the optimiser, and memory with marginals of another graph, are the same bits
/// as those from nothing.
fn check_shared<G: PoseGroup<DOF>, const DOF: usize>(seed: u64) {
    let mut memory = Vec::new();
    for (nodes, kernel) in [
        (40, None),
        (10, Some(Kernel::Truncated { width: 0.3, convexity: 1.0 })),
        (60, Some(Kernel::Cauchy(0.5))),
    ] {
        let problem = two_walks::<G, DOF>(nodes, kernel, seed);
        let expected = optimize(&problem, &Options::default());
        let mut alone = Marginals::new(&problem, &expected.poses, &expected.weights);
        let (solution, mut shared) = optimize_with_marginals(&problem, &Options::default(), memory);
        assert_eq!(solution.poses, expected.poses);
        // Few nodes at first, then all: both ways to compute blocks.
        let all = 2 * nodes + 30;
        let few = vec![(0, nodes / 2), (nodes + 3, nodes + 1), (0, nodes)];
        let many: Vec<_> = (0..all).map(|node| (node, (node * 7 + 3) % all)).collect();
        for pairs in [few, many] {
            assert_eq!(shared.joint(&pairs), alone.joint(&pairs));
        }
        memory = shared.into_memory();
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn shared_analysis_and_memory_change_no_bit(seed: u64) {
        check_shared::<SE2, 3>(seed / 2);
        check_shared::<SE3, 6>(seed / 2);
    }
}

/// The relative covariance of a chain is the composition of the edges' own covariances.
#[test]
fn a_chain_adds_up_and_does_not_depend_on_the_gauge() {
    let (poses, edges) = noisy_walk::<SE3, 6>(12, 0, 0.05, 5);
    let problem = Problem::new(poses, edges).unwrap();
    let solution = optimize(&problem, &Options::default());
    let mut marginals = Marginals::new(&problem, &solution.poses, &solution.weights);
    let relative = marginals.relative(&[(7, 8), (2, 9)]);
    let own = problem.edges()[7].information.try_inverse().unwrap();
    assert!((relative[0].unwrap() - own).amax() < 1e-12, "{} {own}", relative[0].unwrap());
    let mut sum = SMatrix::<f64, 6, 6>::zeros();
    for edge in &problem.edges()[2..9] {
        let covariance = edge.information.try_inverse().unwrap();
        sum = posecut_geometry::covariance::compose(&sum, &edge.measurement, &covariance);
    }
    assert!((relative[1].unwrap() - sum).amax() < 1e-9 * sum.amax());
}

#[test]
fn what_edges_do_not_determine_has_no_covariance() {
    let step = SE2::new(1.0, 0.0, 0.1);
    let edge = |from, to, information| Edge::new(from, to, step, information, EdgeKind::Odometry);
    let flat = Matrix3::from_diagonal(&nalgebra::Vector3::new(1.0, 1.0, 0.0));
    let edges = vec![edge(0, 1, Matrix3::identity()), edge(2, 3, flat), edge(5, 6, Matrix3::identity())];
    let poses = vec![SE2::identity(); 7];
    let problem = Problem::new(poses.clone(), edges).unwrap();
    let mut marginals = Marginals::new(&problem, &poses, &[1.0, 1.0, 0.0]);
    let found = marginals.relative(&[(0, 1), (1, 2), (2, 3), (4, 4), (5, 6), (0, 7)]);
    let there: Vec<_> = found.iter().map(Option::is_some).collect();
    assert_eq!(there, [true, false, false, true, false, false]);
    assert_eq!(marginals.undetermined().collect::<Vec<_>>(), [(3, 2)]);
}

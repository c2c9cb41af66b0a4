//! Priors: measurements of single nodes.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use crate::noisy_walk::{apart, disturbed_walk};
use nalgebra::{DMatrix, DVector, SMatrix, SVector};
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_optimize::{
    Edge, EdgeKind, Graduated, Initialisation, Kernel, Marginals, Method, Options, PoseGroup, Prior, Problem,
    certify, chi_square, optimize, residual,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const STARTS: [Initialisation; 4] =
    [Initialisation::Given, Initialisation::SpanningTree, Initialisation::Chordal, Initialisation::Best];
const METHODS: [Method; 3] = [Method::LevenbergMarquardt, Method::GaussNewton, Method::Dogleg];

/// Number of translation components.
fn axes<const DOF: usize>() -> usize {
    DOF / 2 + DOF % 2
}

/// The information of a position: this matrix without its rotation.
fn flat<const DOF: usize>(full: &SMatrix<f64, DOF, DOF>) -> SMatrix<f64, DOF, DOF> {
    SMatrix::from_fn(|row, column| if row.max(column) < axes::<DOF>() { full[(row, column)] } else { 0.0 })
}

/// A far motion.
fn far<G: LieGroup<DOF>, const DOF: usize>() -> G {
    let mut tangent = SVector::<f64, DOF>::from_element(40.0);
    for axis in axes::<DOF>()..DOF {
        tangent[axis] = 0.9 + 0.2 * axis as f64;
    }
    G::exp(&tangent)
}

/// A walk with priors of both kinds that are off by up to `noise`, in a frame far from that of the given poses.
fn measured_walk<G: PoseGroup<DOF>, const DOF: usize>(
    seed: u64,
    noise: f64,
) -> (Vec<G>, Vec<Edge<G, DOF>>, Vec<Prior<G, DOF>>) {
    let (given, edges) = disturbed_walk::<G, DOF>(14, 8, seed);
    let mut random = ChaCha8Rng::seed_from_u64(seed + 17);
    let priors = (0..14).step_by(2).map(|node| {
        let spread = SMatrix::<f64, DOF, DOF>::from_fn(|_, _| random.random_range(-1.0..1.0));
        let information = (spread * spread.transpose() + SMatrix::identity()) * 5.0;
        let error = SVector::from_fn(|_, _| random.random_range(-1.0..1.0) * noise);
        let measured = far::<G, DOF>().compose(&given[node]).compose(&G::exp(&error));
        if node % 4 == 0 {
            Prior::pose(node, measured, information)
        } else {
            Prior::position(node, measured, flat(&information))
        }
    });
    let priors = priors.collect();
    (given, edges, priors)
}

/// The whitened residuals: `L^T e` with `Omega = L L^T`, where a semidefinite matrix gets its root by eigenvalues.
fn whitened<G: PoseGroup<DOF>, const DOF: usize>(problem: &Problem<G, DOF>, poses: &[G]) -> DVector<f64> {
    let root = |information: &SMatrix<f64, DOF, DOF>| {
        let dense = DMatrix::from_fn(DOF, DOF, |row, column| information[(row, column)]);
        let eigen = dense.symmetric_eigen();
        DMatrix::from_diagonal(&eigen.eigenvalues.map(|value| value.max(0.0).sqrt()))
            * eigen.eigenvectors.transpose()
    };
    let dense = |error: SVector<f64, DOF>| DVector::from_column_slice(error.as_slice());
    let edges = problem.edges().iter().map(|edge| {
        root(&edge.information) * dense(residual(&edge.measurement, &poses[edge.from], &poses[edge.to]))
    });
    let priors = problem
        .priors()
        .iter()
        .map(|prior| root(&prior.information) * dense(prior.residual(&poses[prior.node])));
    DVector::from_vec(edges.chain(priors).flat_map(|part| part.iter().copied().collect::<Vec<_>>()).collect())
}

/// Central differences of the whitened residuals by all poses.
fn jacobian<G: PoseGroup<DOF>, const DOF: usize>(problem: &Problem<G, DOF>, poses: &[G]) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = (0..poses.len() * DOF)
        .map(|column| {
            let at = |offset: f64| {
                let mut tangent = SVector::<f64, DOF>::zeros();
                tangent[column % DOF] = offset;
                let mut moved = poses.to_vec();
                moved[column / DOF] = moved[column / DOF].compose(&G::exp(&tangent));
                whitened(problem, &moved)
            };
            (at(1e-6) - at(-1e-6)) / 2e-6
        })
        .collect();
    DMatrix::from_columns(&columns)
}

/// From every start and by every method the result is stationary, and its covariances are the inverse of `J^T J`: no node is held.
fn the_result_is_stationary_with_dense_covariances<G: PoseGroup<DOF>, const DOF: usize>(seed: u64) {
    let (given, edges, priors) = measured_walk::<G, DOF>(seed, 0.3);
    let problem = Problem::new(given, edges).unwrap().with_priors(priors).unwrap();
    let reference = optimize(&problem, &Options::default());
    assert!(reference.converged);
    assert!((reference.cost - chi_square(&problem, &reference.poses)).abs() < 1e-9 * reference.cost);
    let derivative = jacobian(&problem, &reference.poses);
    let residuals = whitened(&problem, &reference.poses);
    let slope = derivative.tr_mul(&residuals).amax();
    assert!(slope < 1e-4 * residuals.norm(), "{slope}");
    let covariance = (derivative.transpose() * &derivative).try_inverse().unwrap();
    let mut marginals = Marginals::new(&problem, &reference.poses, &reference.all_weights());
    for (node, found) in marginals.poses(&(0..14).collect::<Vec<_>>()).into_iter().enumerate() {
        let expected = covariance.view((node * DOF, node * DOF), (DOF, DOF));
        let off = (DMatrix::from_column_slice(DOF, DOF, found.unwrap().as_slice()) - expected).amax();
        assert!(off < 1e-5 * expected.amax(), "node {node}: {off}");
    }
    for initialisation in STARTS {
        for method in METHODS {
            // The given poses are far away in another frame: plain Gauss-Newton steps need not converge from there.
            if initialisation == Initialisation::Given && method == Method::GaussNewton {
                continue;
            }
            let found = optimize(&problem, &Options { initialisation, method, ..Options::default() });
            assert!(found.converged, "{initialisation:?} {method:?}");
            assert!(
                (found.cost - reference.cost).abs() < 1e-7 * reference.cost,
                "{initialisation:?} {method:?}"
            );
        }
    }
}

#[test]
fn results_are_stationary_with_dense_covariances() {
    for seed in [3, 58] {
        the_result_is_stationary_with_dense_covariances::<SE2, 3>(seed);
        the_result_is_stationary_with_dense_covariances::<SE3, 6>(seed);
    }
}

/// The prior of a pose is an edge from a held node at the origin.
fn a_pose_prior_is_an_edge_from_the_origin<G: PoseGroup<DOF>, const DOF: usize>(seed: u64) {
    let (given, edges, mut priors) = measured_walk::<G, DOF>(seed, 0.3);
    priors.retain(|prior| prior.node % 4 == 0);
    let origin = given.len();
    let mut longer = given.clone();
    longer.push(G::identity());
    let mut more = edges.clone();
    more.extend(
        priors.iter().map(|p| Edge::new(origin, p.node, p.measurement, p.information, EdgeKind::Landmark)),
    );
    let by_edges = Problem::new(longer, more).unwrap().hold([origin]).unwrap();
    let by_priors = Problem::new(given, edges).unwrap().with_priors(priors).unwrap();
    let (edges, priors) =
        (optimize(&by_edges, &Options::default()), optimize(&by_priors, &Options::default()));
    assert!((edges.cost - priors.cost).abs() < 1e-9 * edges.cost, "{} {}", edges.cost, priors.cost);
    assert!(apart(&edges.poses[..origin], &priors.poses) < 1e-5);
    let nodes: Vec<usize> = (0..origin).collect();
    let mut first = Marginals::new(&by_edges, &edges.poses, &[]);
    let mut second = Marginals::new(&by_priors, &priors.poses, &[]);
    for (one, other) in first.poses(&nodes).into_iter().zip(second.poses(&nodes)) {
        let (one, other) = (one.unwrap(), other.unwrap());
        assert!((one - other).amax() < 1e-6 * one.amax());
    }
}

#[test]
fn pose_priors_are_edges_from_the_origin() {
    for seed in [5, 71] {
        a_pose_prior_is_an_edge_from_the_origin::<SE2, 3>(seed);
        a_pose_prior_is_an_edge_from_the_origin::<SE3, 6>(seed);
    }
}

/// Exact priors move the free solution rigidly: one pose does, and so do the positions of as many nodes as fix a rigid body.
fn exact_priors_only_move_the_solution<G: PoseGroup<DOF>, const DOF: usize>(seed: u64) {
    let (given, edges) = disturbed_walk::<G, DOF>(14, 8, seed);
    let free = optimize(&Problem::new(given.clone(), edges.clone()).unwrap(), &Options::default());
    let moved: Vec<G> = free.poses.iter().map(|pose| far::<G, DOF>().compose(pose)).collect();
    let one = vec![Prior::pose(6, moved[6], SMatrix::identity())];
    let position = |node: usize| Prior::position(node, moved[node], flat(&SMatrix::identity()));
    let several = [1, 6, 11].into_iter().take(axes::<DOF>()).map(position).collect();
    for priors in [one, several] {
        let problem = Problem::new(given.clone(), edges.clone()).unwrap().with_priors(priors).unwrap();
        let found = optimize(&problem, &Options::default());
        assert!(
            found.converged && (found.cost - free.cost).abs() < 1e-9 * free.cost,
            "{} {}",
            found.cost,
            free.cost
        );
        assert!(apart(&found.poses, &moved) < 1e-4, "{}", apart(&found.poses, &moved));
        let report = &found.components[0];
        assert!(report.held == 0 && !report.free && report.undetermined.is_none(), "{report:?}");
        assert!(!certify(&problem, &found.poses)[0].global, "the certificate does not cover priors");
        assert!(certify(&problem, &found.poses)[0].cost.is_nan());
    }
}

#[test]
fn exact_priors_only_move_solutions() {
    for seed in [2, 33] {
        exact_priors_only_move_the_solution::<SE2, 3>(seed);
        exact_priors_only_move_the_solution::<SE3, 6>(seed);
    }
}

/// Fewer positions than fix a rigid body leave the cost of the free solution, meet the positions, and are reported.
fn few_positions_leave_a_rotation_free<G: PoseGroup<DOF>, const DOF: usize>(nodes: usize, positions: usize) {
    let (given, edges) = disturbed_walk::<G, DOF>(nodes, 8, 4);
    let free = optimize(&Problem::new(given.clone(), edges.clone()).unwrap(), &Options::default());
    let exact = |node: usize| far::<G, DOF>().compose(&free.poses[node]);
    let priors =
        (0..positions).map(|node| Prior::position(3 * node, exact(3 * node), flat(&SMatrix::identity())));
    let problem = Problem::new(given, edges).unwrap().with_priors(priors.collect()).unwrap();
    let found = optimize(&problem, &Options::default());
    assert!(found.converged && found.components[0].free, "{:?}", found.components);
    assert!((found.cost - free.cost).abs() < 1e-6 * free.cost, "{} {}", found.cost, free.cost);
    let worst = problem.priors().iter().map(|prior| prior.squared(&found.poses[prior.node]));
    assert!(worst.fold(0.0, f64::max) < 1e-6);
}

#[test]
fn too_few_positions_leave_rotations_free() {
    for nodes in [14, 1000] {
        few_positions_leave_a_rotation_free::<SE2, 3>(nodes, 1);
        few_positions_leave_a_rotation_free::<SE3, 6>(nodes, 1);
        few_positions_leave_a_rotation_free::<SE3, 6>(nodes, 2);
    }
}

/// A held node and priors together: the node stays, and the priors pull the rest.
#[test]
fn held_nodes_stay_beside_priors() {
    let (given, edges, priors) = measured_walk::<SE2, 3>(9, 0.3);
    let home = far::<SE2, 3>().inverse();
    let priors =
        priors.into_iter().map(|p| Prior { measurement: home.compose(&p.measurement), ..p }).collect();
    let problem = Problem::new(given.clone(), edges).unwrap().with_priors(priors).unwrap().hold([4]).unwrap();
    let found = optimize(&problem, &Options::default());
    assert!(found.converged && found.components[0].held == 1);
    assert_eq!(found.poses[4], given[4]);
    let all = jacobian(&problem, &found.poses).tr_mul(&whitened(&problem, &found.poses));
    for (row, slope) in all.iter().enumerate().filter(|(row, _)| row / 3 != 4) {
        assert!(slope.abs() < 1e-3, "{row}: {slope}");
    }
}

/// A node without edges goes to its prior, and components are independent.
#[test]
fn lone_nodes_and_other_components() {
    let (mut given, edges, _) = measured_walk::<SE2, 3>(9, 0.0);
    given.push(SE2::identity());
    given.push(SE2::new(1.0, 2.0, 0.3));
    let at = SE2::new(50.0, -7.0, 2.0);
    let priors = vec![Prior::pose(14, at, SMatrix::identity())];
    let problem = Problem::new(given.clone(), edges).unwrap().with_priors(priors).unwrap();
    let found = optimize(&problem, &Options::default());
    assert!(apart(&found.poses[14..15], &[at]) < 1e-9);
    assert_eq!(
        (found.poses[0], found.poses[15]),
        (given[0], given[15]),
        "the gauge of a component without priors"
    );
    let counts: Vec<usize> = found.components.iter().map(|report| report.priors).collect();
    assert_eq!(counts, [0, 1, 0]);
}

/// Kernels and graduation weigh priors: with two gross outliers of seven priors the result is nearly that without them.
fn outliers_lose_their_weight<G: PoseGroup<DOF>, const DOF: usize>(seed: u64) {
    let (given, edges, mut priors) = measured_walk::<G, DOF>(seed, 0.02);
    let clean = Problem::new(given.clone(), edges.clone()).unwrap().with_priors(priors.clone()).unwrap();
    let clean = optimize(&clean, &Options::default());
    let mut away = SVector::<f64, DOF>::zeros();
    away[0] = 30.0;
    for outlier in [1, 4] {
        priors[outlier].measurement = G::exp(&away).compose(&priors[outlier].measurement);
    }
    let solve = |kernel: Option<Kernel>, graduated: Option<Graduated>| {
        let priors = priors.iter().map(|prior| Prior { kernel, ..*prior }).collect();
        let problem = Problem::new(given.clone(), edges.clone()).unwrap().with_priors(priors).unwrap();
        optimize(&problem, &Options { graduated, ..Options::default() })
    };
    let plain = apart(&solve(None, None).poses, &clean.poses);
    let cauchy = apart(&solve(Some(Kernel::Cauchy(1.0)), None).poses, &clean.poses);
    let graduated = solve(None, Some(Graduated::TruncatedLeastSquares(3.0)));
    let gnc = apart(&graduated.poses, &clean.poses);
    assert!(plain > 1.0 && cauchy < 0.2 && gnc < 0.1, "{plain} {cauchy} {gnc}");
    let rejected: Vec<usize> = (0..7).filter(|&prior| graduated.prior_weights[prior] < 0.5).collect();
    assert_eq!(rejected, [1, 4], "{:?}", graduated.prior_weights);
}

#[test]
fn outliers_among_priors_lose_their_weight() {
    for seed in [6, 90] {
        outliers_lose_their_weight::<SE2, 3>(seed);
        outliers_lose_their_weight::<SE3, 6>(seed);
    }
}

#[test]
fn impossible_priors_are_refused() {
    let node = || Problem::new(vec![SE2::identity()], Vec::new()).unwrap();
    let refused = |prior: Prior<SE2, 3>| node().with_priors(vec![prior]).unwrap_err().to_string();
    let one = SMatrix::<f64, 3, 3>::identity();
    let at = SE2::identity();
    assert!(refused(Prior::pose(1, at, one)).contains("names node 1, but there are 1 nodes"));
    assert!(refused(Prior::pose(0, SE2::new(f64::NAN, 0.0, 0.0), one)).contains("not finite"));
    assert!(refused(Prior::pose(0, at, one * f64::INFINITY)).contains("not finite"));
    assert!(refused(Prior::pose(0, at, -one)).contains("semidefinite"));
    assert!(refused(Prior::position(0, at, one)).contains("weighs a rotation"));
    let kernel = Some(Kernel::Huber(-1.0));
    assert!(refused(Prior { kernel, ..Prior::pose(0, at, one) }).contains("parameter -1"));
    assert!(node().with_priors(vec![Prior::position(0, at, flat(&one))]).is_ok());
}

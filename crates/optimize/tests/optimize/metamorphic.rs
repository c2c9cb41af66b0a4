//! Changes that must not affect the solution: units, scales, numbering, directions, frames, copies, and unconnected graphs.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use nalgebra::SVector;
use posecut_geometry::{SE2, SE3};
use posecut_optimize::{EdgeKind, Graduated, Method, Options, PoseGroup, Problem, optimize};

use crate::changes::{Changed, Graph, changes, largest_gap, scaled};
use crate::noisy_walk::noisy_walk;

#[derive(Clone, Copy, Debug)]
enum Estimator {
    Batch(Method),
    Graduated(fn(f64) -> Graduated),
}

/// Whether it converged, and the poses. `deviation` is the size of one standard deviation in the changed graph.
fn estimate<G: PoseGroup<DOF>, const DOF: usize>(
    estimator: Estimator,
    (poses, edges): &Graph<G, DOF>,
    deviation: f64,
) -> (bool, Vec<G>) {
    let batch = |options: Options| {
        let solution = optimize(&Problem::new(poses.clone(), edges.clone()).unwrap(), &options);
        (solution.converged, solution.poses)
    };
    // The default share of 1e-10 leaves weak directions 1e-5 standard deviations off.
    let precise = Options { cost_tolerance: 1e-14, ..Options::default() };
    match estimator {
        Estimator::Batch(method) => batch(Options { method, ..precise }),
        Estimator::Graduated(cost) => batch(Options { graduated: Some(cost(4.0 * deviation)), ..precise }),
    }
}

fn check<G: PoseGroup<DOF>, const DOF: usize>(false_edges: bool) {
    let (poses, mut edges) = noisy_walk::<G, DOF>(60, 40, 0.05, 8);
    if false_edges {
        for (turn, edge) in edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark).enumerate() {
            if turn % 8 == 0 {
                let error = SVector::from_fn(|axis, _| 2.0 + 0.3 * axis as f64);
                edge.measurement = edge.measurement.compose(&G::exp(&error));
            }
        }
    }
    let graph = (poses, edges);
    let estimators = [
        Estimator::Batch(Method::LevenbergMarquardt),
        Estimator::Batch(Method::GaussNewton),
        Estimator::Batch(Method::Dogleg),
        Estimator::Graduated(Graduated::TruncatedLeastSquares),
        Estimator::Graduated(Graduated::GemanMcClure),
    ];
    for estimator in estimators {
        let is_graduated = matches!(estimator, Estimator::Graduated(_));
        if is_graduated != false_edges {
            continue;
        }
        let (converged, plain) = estimate(estimator, &graph, 1.0);
        assert!(converged, "{estimator:?}");
        for Changed { name, graph: changed, places, unit, deviation } in changes(&graph) {
            if is_graduated && deviation.is_nan() {
                continue;
            }
            let (converged, found) = estimate(estimator, &changed, deviation);
            assert!(converged, "{estimator:?}, {name}");
            let back: Vec<G> = places.iter().map(|&place| scaled(&found[place], 1.0 / unit)).collect();
            let gap = largest_gap(&plain, &back);
            assert!(gap < 1e-6, "{estimator:?}, {name}: {gap:e}");
        }
    }
}

#[test]
fn what_changes_no_solution_in_the_plane() {
    check::<SE2, 3>(false);
    check::<SE2, 3>(true);
}

#[test]
fn what_changes_no_solution_in_space() {
    check::<SE3, 6>(false);
    check::<SE3, 6>(true);
}

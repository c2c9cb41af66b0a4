//! Convergence depends neither on the unit of length nor on the scale of the information.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use nalgebra::SMatrix;
use posecut_geometry::{SE2, SE3};
use posecut_optimize::{Edge, Initialisation, Method, Options, PoseGroup, Problem, Solution, optimize};

use crate::changes::{in_units, largest_gap, with_information_times};
use crate::g2o;
use crate::noisy_walk::noisy_walk;

fn solve<G: PoseGroup<DOF>, const DOF: usize>(
    method: Method,
    (poses, edges): &(Vec<G>, Vec<Edge<G, DOF>>),
) -> Solution<G> {
    let problem = Problem::new(poses.clone(), edges.clone()).unwrap();
    optimize(
        &problem,
        &Options { initialisation: Initialisation::SpanningTree, method, ..Options::default() },
    )
}

/// Checks that other scales of the information and other units do not change the course of the iteration.
fn check<G: PoseGroup<DOF>, const DOF: usize>(noise: f64) {
    let graph = noisy_walk::<G, DOF>(80, 40, noise, 3);
    for method in [Method::LevenbergMarquardt, Method::GaussNewton, Method::Dogleg] {
        let plain = solve(method, &graph);
        assert!(plain.converged, "{method:?}: {:?}", plain.components);
        let scales = [1e-15, 1e-12, 1e-6, 1e-3, 1e3, 1e6, 1e12, 1e15].map(|scale| (scale, 1.0));
        let units = [1e-3, 1e3, 1e6].map(|unit| (1.0, unit));
        for (scale, unit) in scales.into_iter().chain(units).chain([(1e-15, 1e3), (1e15, 1e3)]) {
            let scaled = with_information_times(scale, &in_units(unit, &graph));
            let found = solve(method, &scaled);
            let case = format!("{method:?}, noise {noise}, information times {scale:e}, unit {unit:e}");
            let gap = largest_gap(&plain.poses, &in_units(1.0 / unit, &(found.poses.clone(), scaled.1)).0);
            assert!(gap < 1e-7, "{case}: {gap:e}");
            let (a, b) = (&plain.components[0], &found.components[0]);
            assert!(a.iterations.abs_diff(b.iterations) <= 1, "{case}: {a:?} {b:?}");
            assert!(b.termination.converged(), "{case}: {b:?}");
            if noise > 1e-3 {
                assert_eq!((a.termination, a.iterations), (b.termination, b.iterations), "{case}");
                assert!(
                    (found.chi_square / scale - plain.chi_square).abs() < 1e-9 * plain.chi_square,
                    "{case}"
                );
            }
        }
    }
}

#[test]
fn scale_and_unit_change_no_iteration_in_the_plane() {
    check::<SE2, 3>(0.05);
    check::<SE2, 3>(f64::MIN_POSITIVE);
}

#[test]
fn scale_and_unit_change_no_iteration_in_space() {
    check::<SE3, 6>(0.05);
    check::<SE3, 6>(f64::MIN_POSITIVE);
}

/// A regression: a start counted as converged because its gradient, in inverse metres, was small.
#[test]
fn weak_information_was_taken_for_convergence() {
    let Some(text) = g2o::text("M3500a") else { return };
    let (poses, mut edges) = g2o::planar(&text);
    for edge in &mut edges {
        edge.information *= 1e-12;
    }
    for method in [Method::LevenbergMarquardt, Method::Dogleg] {
        let problem = Problem::new(poses.clone(), edges.clone()).unwrap();
        let solution = optimize(&problem, &Options { method, ..Options::default() });
        assert!(
            (solution.chi_square * 1e12 - 912.191_624_43).abs() < 1e-6,
            "{method:?}: {}",
            solution.chi_square
        );
        assert!(solution.converged && solution.iterations > 2, "{method:?}: {:?}", solution.components);
    }
}

/// A regression: the 1 on the diagonal for the held translation counted as the largest entry, so that with weak information
/// every eigenvalue passed as rounding.
#[test]
fn weak_information_was_certified_whatever_the_poses() {
    let corner = SE2::new(1.0, 0.0, std::f64::consts::FRAC_PI_3);
    // A ring of six corners that winds twice is a minimum, but not the lowest.
    let wound = SE2::new(1.0, 0.0, 2.0 * std::f64::consts::FRAC_PI_3);
    let certify = |scale: f64, step: SE2| {
        let information = SMatrix::<f64, 3, 3>::identity() * scale;
        let mut poses = vec![SE2::new(0.0, 0.0, 0.0)];
        for index in 1..6 {
            poses.push(posecut_geometry::LieGroup::compose(&poses[index - 1], &step));
        }
        let edges = (0..6)
            .map(|index| {
                Edge::new(index, (index + 1) % 6, corner, information, posecut_optimize::EdgeKind::Odometry)
            })
            .collect();
        posecut_optimize::certify(&Problem::new(poses.clone(), edges).unwrap(), &poses)[0].global
    };
    for scale in [1e-15, 1.0, 1e15] {
        assert!(certify(scale, corner), "{scale:e}");
        assert!(!certify(scale, wound), "{scale:e}");
    }
}

/// A regression: comparisons with NaN are false, so that the largest entry of a gradient with NaN was zero.
#[test]
fn a_cost_that_is_not_finite_is_no_convergence() {
    let (poses, mut edges) = noisy_walk::<SE2, 3>(10, 5, 0.05, 7);
    edges[12].information *= 1e300;
    edges[12].measurement.translation.x = 1e80;
    for method in [Method::LevenbergMarquardt, Method::GaussNewton, Method::Dogleg] {
        let solution = solve(method, &(poses.clone(), edges.clone()));
        assert!(!solution.cost.is_finite() && !solution.converged, "{method:?}: {:?}", solution.components);
    }
}

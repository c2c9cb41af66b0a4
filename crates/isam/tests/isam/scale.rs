//! Relinearisation and convergence depend neither on the unit of length nor on the scale of the information.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use posecut_geometry::{LieGroup as _, SE2};
use posecut_isam::{IncrementalOptions, IncrementalSolver};
use posecut_optimize::Edge;

use crate::noisy_walk::noisy_walk;

/// A regression: linearisation errors were compared with a cost of 1e-6 per edge, so that weak edges were never relinearised.
#[test]
fn weak_information_was_never_linearised_again() {
    let (_, edges) = noisy_walk::<SE2, 3>(200, 100, 0.05, 5);
    let relinearised = |scale: f64| {
        let mut solver = IncrementalSolver::<SE2, 3>::new(IncrementalOptions::default()).unwrap();
        let mut count = 0;
        for node in 0..200 {
            solver.add_pose(SE2::identity()).unwrap();
            for edge in edges.iter().filter(|edge| edge.from.max(edge.to) == node) {
                solver.add_edge(Edge { information: edge.information * scale, ..*edge }).unwrap();
            }
            count += solver.update().relinearised;
        }
        let report = solver.finish();
        assert!(report.converged, "{scale:e}: {report:?}");
        (count, report.cost / scale)
    };
    let (count, cost) = relinearised(1.0);
    for scale in [1e-15, 1e-9, 1e9, 1e15] {
        let (scaled_count, scaled_cost) = relinearised(scale);
        assert!(
            count > 100 && scaled_count.abs_diff(count) < count / 20,
            "{scale:e}: {scaled_count} {count}"
        );
        assert!((scaled_cost - cost).abs() < 1e-9 * cost, "{scale:e}: {scaled_cost} {cost}");
    }
}

/// A regression: comparisons with NaN are false, so that the largest entry of a gradient with NaN was zero.
#[test]
fn a_cost_that_is_not_finite_is_no_convergence() {
    let (poses, mut edges) = noisy_walk::<SE2, 3>(10, 5, 0.05, 7);
    edges[12].information *= 1e300;
    edges[12].measurement.translation.x = 1e80;
    let mut solver = IncrementalSolver::<SE2, 3>::new(IncrementalOptions::default()).unwrap();
    for pose in poses {
        solver.add_pose(pose).unwrap();
    }
    for edge in edges {
        solver.add_edge(edge).unwrap();
    }
    solver.update();
    let report = solver.finish();
    assert!(!report.cost.is_finite() && !report.converged, "{report:?}");
}

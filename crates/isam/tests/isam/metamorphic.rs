//! Changes that must not affect the estimate: units, scales, numbering, directions, frames, copies, and unconnected graphs.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use posecut_geometry::{SE2, SE3};
use posecut_isam::{IncrementalGroup, IncrementalOptions, IncrementalSolver};

use crate::changes::{Changed, Graph, changes, largest_gap, scaled};
use crate::noisy_walk::noisy_walk;

/// Whether it converged, and the poses.
fn estimate<G: IncrementalGroup<DOF>, const DOF: usize>((poses, edges): &Graph<G, DOF>) -> (bool, Vec<G>) {
    let mut solver = IncrementalSolver::new(IncrementalOptions::default()).unwrap();
    for &pose in poses {
        solver.add_pose(pose).unwrap();
    }
    for (place, &edge) in edges.iter().enumerate() {
        solver.add_edge(edge).unwrap();
        if place % 7 == 0 {
            solver.update();
        }
    }
    solver.update();
    (solver.finish().converged, solver.estimates())
}

fn check<G: IncrementalGroup<DOF>, const DOF: usize>() {
    let graph = noisy_walk::<G, DOF>(60, 40, 0.05, 8);
    let (converged, plain) = estimate(&graph);
    assert!(converged);
    for Changed { name, graph: changed, places, unit, .. } in changes(&graph) {
        let (converged, found) = estimate(&changed);
        assert!(converged, "{name}");
        let back: Vec<G> = places.iter().map(|&place| scaled(&found[place], 1.0 / unit)).collect();
        let gap = largest_gap(&plain, &back);
        assert!(gap < 1e-6, "{name}: {gap:e}");
    }
}

#[test]
fn what_changes_no_estimate_in_the_plane() {
    check::<SE2, 3>();
}

#[test]
fn what_changes_no_estimate_in_space() {
    check::<SE3, 6>();
}

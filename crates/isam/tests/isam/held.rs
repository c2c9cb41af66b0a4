//! Held nodes: g2o's `FIX`.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use nalgebra::SMatrix;
use posecut_geometry::SE2;
use posecut_isam::{IncrementalOptions, IncrementalSolver};
use posecut_optimize::{Edge, EdgeKind, Options, Problem, optimize};

use crate::noisy_walk::{apart, bits, disturbed_walk as graph};

#[test]
fn held_poses_that_come_one_by_one_end_where_the_batch_solver_puts_the_others() {
    let (given, edges) = graph::<SE2, 3>(30, 20, 11);
    // The last node is held in some cases: a join must then not move the later component.
    for held in [vec![0], vec![17], vec![4, 20], vec![3, 4, 29]] {
        let problem = Problem::new(given.clone(), edges.clone()).unwrap().hold(held.iter().copied()).unwrap();
        let expected = optimize(&problem, &Options { cost_tolerance: 0.0, ..Options::default() });
        let mut solver = IncrementalSolver::new(IncrementalOptions::default()).unwrap();
        for (node, pose) in given.iter().enumerate() {
            if held.contains(&node) {
                solver.add_held_pose(*pose).unwrap();
            } else {
                solver.add_pose(*pose).unwrap();
            }
            for edge in edges.iter().filter(|edge| edge.from.max(edge.to) == node) {
                solver.add_edge(*edge).unwrap();
            }
            solver.update();
        }
        solver.finish();
        let (found, cost) = (solver.estimates(), solver.cost());
        assert!((cost - expected.chi_square).abs() < 1e-9 * cost, "{held:?}: {cost} {}", expected.chi_square);
        assert!(apart(&found, &expected.poses) < 1e-6, "{held:?}: {}", apart(&found, &expected.poses));
        assert!(held.iter().all(|&node| bits(&found[node]) == bits(&given[node])), "{held:?}");
    }
}

/// Two components, both with a held node in the middle, lose and regain the edge that joins them.
#[test]
fn a_part_that_is_split_off_keeps_its_own_held_pose_as_gauge() {
    let mut solver = IncrementalSolver::new(IncrementalOptions::default()).unwrap();
    let step = SE2::new(1.0, 0.0, 0.1);
    let edge = |from| Edge::new(from, from + 1, step, SMatrix::identity(), EdgeKind::Odometry);
    let places: Vec<SE2> = (0..6).map(|node| SE2::new(1.1 * f64::from(node), 0.0, 0.0)).collect();
    for (node, place) in places.iter().enumerate() {
        if [1, 4].contains(&node) { solver.add_held_pose(*place) } else { solver.add_pose(*place) }.unwrap();
    }
    let ids: Vec<_> = (0..5).map(|from| solver.add_edge(edge(from)).unwrap()).collect();
    solver.finish();
    let (joined, cost) = (solver.estimates(), solver.cost());
    assert!(cost > 1e-3, "two held poses and three edges between them contradict each other: {cost}");
    let taken = solver.remove_edge(ids[2]).unwrap();
    let split = solver.update().splits;
    assert!(split.len() == 1 && [1, 4].contains(&split[0].gauge), "{split:?}");
    solver.finish();
    assert!(solver.cost() < 1e-12, "{}", solver.cost());
    assert!([1, 4].iter().all(|&node| bits(&solver.estimate(node)) == bits(&places[node])));
    solver.add_edge(taken).unwrap();
    solver.finish();
    assert!(apart(&joined, &solver.estimates()) < 1e-6);
}

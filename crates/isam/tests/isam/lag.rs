//! The option `lag`: memory, determinism, keyframes, held poses and false edges.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use nalgebra::Matrix3;
use posecut_geometry::{LieGroup as _, SE2, SE3};
use posecut_isam::{IncrementalOptions, IncrementalSolver};
use posecut_optimize::{Edge, EdgeKind};

use crate::growing::{planar, spatial};
use crate::lagged::{apart_on_live, play, session};
use crate::noisy_walk::bits;

/// Several held poses in the past: one stays in the prior.
#[test]
fn held_poses_anchor_the_past() {
    let session = session::<SE2, 3>(9, 1e-5, [40, 8], planar);
    let solve = |lag: Option<usize>| {
        let mut solver =
            IncrementalSolver::<SE2, 3>::new(IncrementalOptions { lag, ..IncrementalOptions::default() })
                .unwrap();
        for (node, pose) in session.world.truth.iter().enumerate() {
            if [0, 2, 5, 11, 30].contains(&node) {
                solver.add_held_pose(*pose)
            } else {
                solver.add_pose(*pose)
            }
            .unwrap();
            for (_, edge) in session.edges.iter().filter(|(at, _)| *at == node) {
                solver.add_edge(*edge).unwrap();
            }
            solver.update();
        }
        assert!(solver.finish().converged);
        solver
    };
    let (full, lagged) = (solve(None), solve(Some(10)));
    assert!(apart_on_live(&lagged, &full.estimates()) < 1e-8);
    assert!(lagged.prior_sizes().iter().sum::<usize>() <= 12, "{:?}", lagged.prior_sizes());
}

#[test]
fn memory_depends_on_the_lag_and_not_on_the_session() {
    let options = IncrementalOptions { lag: Some(50), ..IncrementalOptions::default() };
    let mut solver = IncrementalSolver::<SE2, 3>::new(options).unwrap();
    let session = session::<SE2, 3>(1, 0.02, [3000, 30], |random| {
        use rand::RngExt as _;
        SE2::new(1.0, 0.0, random.random_range(-0.3..0.3))
    });
    let largest = std::cell::RefCell::new([[0; 5]; 2]);
    play(&mut solver, &session, |solver, node| {
        let now = [
            solver.live_poses().len(),
            solver.edge_count(),
            solver.prior_sizes().len(),
            solver.prior_sizes().iter().sum(),
            solver.tree_blocks(),
        ];
        let half = &mut largest.borrow_mut()[usize::from(node >= 1500)];
        for (largest, now) in half.iter_mut().zip(now) {
            *largest = (*largest).max(now);
        }
    });
    let [early, late] = *largest.borrow();
    assert!(late[0] <= 56 && late[2] <= 1 && late[3] <= 32, "{late:?}");
    assert!(early.iter().zip(late).all(|(&early, late)| late <= early + early / 4), "{early:?} {late:?}");
}

/// The same calls give the same bits.
#[test]
fn a_lag_is_deterministic() {
    let run = || {
        let session = session::<SE3, 6>(2, 0.05, [150, 15], spatial);
        let options = IncrementalOptions { lag: Some(30), ..IncrementalOptions::default() };
        let mut solver = IncrementalSolver::<SE3, 6>::new(options).unwrap();
        play(&mut solver, &session, |_, _| {});
        solver.finish();
        let bits: Vec<_> = solver.estimates().iter().map(bits).collect();
        (bits, solver.cost().to_bits())
    };
    assert_eq!(run(), run());
}

/// Keyframes stay within reach; without landmark edges in the past, every prior is an edge between two poses.
#[test]
fn keyframes_stay_within_reach() {
    let session = session::<SE2, 3>(4, 1e-5, [200, 20], planar);
    let solve = |options: IncrementalOptions| {
        let mut solver = IncrementalSolver::<SE2, 3>::new(options).unwrap();
        play(&mut solver, &session, |_, _| {});
        solver
    };
    let lag = IncrementalOptions { lag: Some(30), ..IncrementalOptions::default() };
    let mut every = solve(IncrementalOptions { keep_every: Some(25), ..lag });
    let mut landmarks = solve(IncrementalOptions { keep_landmark_poses: true, ..lag });
    assert!([25, 50, 150].iter().all(|&pose| !every.is_marginalised(pose)) && every.is_marginalised(26));
    assert!(landmarks.prior_sizes().len() > 5 && landmarks.prior_sizes().iter().all(|&size| size == 2));
    let mut full = solve(IncrementalOptions::default());
    let (from, to) = (25, 199);
    let measured = session.world.truth[from].between(&session.world.truth[to]);
    let closure = Edge::new(from, to, measured, Matrix3::identity() * 1e10, EdgeKind::Landmark);
    for solver in [&mut every, &mut full] {
        solver.add_edge(closure).unwrap();
        assert!(solver.finish().converged);
    }
    assert!(apart_on_live(&every, &full.estimates()) < 1e-7);
    full.remove_edge(full.edges().last().unwrap().0).unwrap();
    full.finish();
    assert!(landmarks.finish().converged && apart_on_live(&landmarks, &full.estimates()) < 1e-7);
}

/// A false edge within the lag leaves no trace, though the past is a prior.
#[test]
fn a_false_edge_within_the_lag_leaves_no_trace() {
    let session = session::<SE2, 3>(6, 0.01, [120, 20], planar);
    let options = IncrementalOptions { lag: Some(60), ..IncrementalOptions::default() };
    let mut solver = IncrementalSolver::<SE2, 3>::new(options).unwrap();
    play(&mut solver, &session, |_, _| {});
    let mut clean = IncrementalSolver::<SE2, 3>::new(options).unwrap();
    play(&mut clean, &session, |_, _| {});
    let wrong = Edge::new(80, 118, SE2::new(0.3, 0.1, 1.0), Matrix3::identity() * 1e4, EdgeKind::Landmark);
    let id = solver.add_edge(wrong).unwrap();
    for _ in 0..3 {
        solver.update();
    }
    let bad = solver.cost();
    solver.remove_edge(id).unwrap();
    solver.update();
    let (found, expected) = (solver.finish(), clean.finish());
    assert!(found.converged && bad > 10.0 * found.cost, "{found:?} {bad}");
    assert!((found.cost - expected.cost).abs() < 1e-8 * expected.cost, "{found:?} {expected:?}");
    assert!(apart_on_live(&solver, &clean.estimates()) < 1e-7);
}

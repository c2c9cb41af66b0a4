//! Compares the incremental solver with fresh batch solutions, on small graphs at every step.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "functions of tests may panic, and one prints its figures"
)]

use crate::growing::{World, distance_from_fresh, planar, spatial};
use nalgebra::Matrix3;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_isam::{
    EdgeId, IncrementalError, IncrementalGroup, IncrementalOptions, IncrementalSolver, Split,
};
use posecut_optimize::{Edge, EdgeKind, Kernel, Options, Problem, ProblemError, optimize};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Checks every step of a session with landmark edges to random earlier poses.
fn follow<G: IncrementalGroup<DOF>, const DOF: usize>(
    seed: u64,
    step: fn(&mut ChaCha8Rng) -> G,
    options: IncrementalOptions,
    tolerance: f64,
) {
    let mut world = World::<G, DOF>::new(seed, 0.02, step);
    let mut solver = IncrementalSolver::new(options).unwrap();
    solver.add_pose(G::identity()).unwrap();
    for _ in 0..60 {
        let node = world.grow();
        assert_eq!(solver.add_pose(G::identity()).unwrap(), node);
        solver.add_edge(world.measure(node - 1, node, EdgeKind::Odometry)).unwrap();
        if node > 2 && world.any(3) == 0 {
            let earlier = world.any(node - 1);
            let edge = if world.any(2) == 0 {
                world.measure(earlier, node, EdgeKind::Landmark)
            } else {
                world.measure(node, earlier, EdgeKind::Landmark)
            };
            solver.add_edge(edge).unwrap();
        }
        let report = solver.update();
        assert!(report.undetermined.is_empty() && report.splits.is_empty(), "{report:?}");
        let (_, cost, optimum) = distance_from_fresh(&solver);
        assert!(
            cost - optimum <= tolerance * optimum.max(1.0),
            "seed {seed}, node {node}: {cost} is above {optimum}"
        );
    }
    let finish = solver.finish();
    let (distance, cost, optimum) = distance_from_fresh(&solver);
    assert!(finish.converged && !finish.restarted, "{finish:?}");
    assert!(distance < 1e-8 && (cost - optimum).abs() <= 1e-10 * optimum, "{distance} {cost} {optimum}");
}

#[test]
fn every_step_is_near_the_batch_optimum() {
    let tight = IncrementalOptions {
        relinearise_translation: 1e-4,
        relinearise_rotation: 1e-4,
        propagate: 0.0,
        linearisation_error: 0.0,
        iterations: 5,
        ..IncrementalOptions::default()
    };
    for seed in 0..4 {
        follow::<SE2, 3>(seed, planar, IncrementalOptions::default(), 1e-3);
        follow::<SE3, 6>(seed, spatial, IncrementalOptions::default(), 1e-3);
        follow::<SE2, 3>(seed, planar, tight, 1e-7);
        follow::<SE3, 6>(seed, spatial, tight, 1e-7);
    }
}

/// Adds, removes and re-adds edges in any order, several per update. Removed odometry splits components, which join again.
fn come_and_go<G: IncrementalGroup<DOF>, const DOF: usize>(
    seed: u64,
    steps: usize,
    step: fn(&mut ChaCha8Rng) -> G,
) -> Result<(), TestCaseError> {
    let mut world = World::<G, DOF>::new(seed, 0.01, step);
    let mut solver = IncrementalSolver::new(IncrementalOptions::default()).unwrap();
    solver.add_pose(G::identity()).unwrap();
    let mut there: Vec<(EdgeId, Edge<G, DOF>)> = Vec::new();
    let mut gone: Vec<(EdgeId, Edge<G, DOF>)> = Vec::new();
    for _ in 0..steps {
        match world.any(8) {
            0..=2 => {
                let node = world.grow();
                solver.add_pose(G::identity()).unwrap();
                let edge = world.measure(node - 1, node, EdgeKind::Odometry);
                there.push((solver.add_edge(edge).unwrap(), edge));
            }
            3..=4 if world.truth.len() > 1 => {
                let count = world.truth.len();
                let (a, b) = (world.any(count), world.any(count));
                if a != b {
                    let edge = world.measure(a, b, EdgeKind::Landmark);
                    there.push((solver.add_edge(edge).unwrap(), edge));
                }
            }
            5..=6 if !there.is_empty() => {
                let (id, edge) = there.swap_remove(world.any(there.len()));
                let removed = solver.remove_edge(id).unwrap();
                prop_assert_eq!(removed.measurement, edge.measurement);
                gone.push((id, edge));
            }
            _ if !gone.is_empty() => {
                let (_, edge) = gone.swap_remove(world.any(gone.len()));
                there.push((solver.add_edge(edge).unwrap(), edge));
            }
            _ => {}
        }
        if world.any(3) > 0 {
            solver.update();
        }
        if world.any(20) == 0 {
            solver.finish();
            let (distance, ..) = distance_from_fresh(&solver);
            prop_assert!(distance < 1e-8, "{distance:e}");
        }
    }
    for (id, _) in &gone {
        prop_assert_eq!(solver.remove_edge(*id).err(), Some(IncrementalError::RemovedEdge { edge: id.0 }));
    }
    let finish = solver.finish();
    let (distance, cost, optimum) = distance_from_fresh(&solver);
    prop_assert!(distance < 1e-8 && finish.converged, "{distance:e} {cost} {optimum} {finish:?}");
    prop_assert!((cost - optimum).abs() <= 1e-8 * optimum.max(1e-3), "{cost} {optimum}");
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn edges_that_come_and_go_leave_no_trace(seed: u64, steps in 1_usize..120) {
        come_and_go::<SE2, 3>(seed, steps, planar)?;
        come_and_go::<SE3, 6>(seed, steps, spatial)?;
    }
}

/// Poses in a line, each joined to the one before and updated; the numbers of the edges.
pub(crate) fn line(count: usize) -> (IncrementalSolver<SE2, 3>, Vec<EdgeId>) {
    let mut solver = IncrementalSolver::new(IncrementalOptions::default()).unwrap();
    solver.add_pose(SE2::identity()).unwrap();
    let mut ids = Vec::new();
    for node in 1..count {
        solver.add_pose(SE2::identity()).unwrap();
        let step = SE2::new(1.0, 0.0, 0.1);
        let edge = Edge::new(node - 1, node, step, Matrix3::identity(), EdgeKind::Odometry);
        ids.push(solver.add_edge(edge).unwrap());
        solver.update();
    }
    (solver, ids)
}

#[test]
fn a_part_that_loses_its_connection_stays_where_it_is_and_is_named() {
    let (mut solver, ids) = line(10);
    let before = solver.estimates();
    let bridge = solver.remove_edge(ids[5]).unwrap();
    assert_eq!(solver.parts(), 2);
    assert_eq!(solver.update().splits, [Split { gauge: 6, nodes: 4 }]);
    assert!(solver.update().splits.is_empty(), "a split is told once");
    for (after, before) in solver.estimates().iter().zip(&before) {
        assert!(after.between(before).log().amax() < 1e-12);
    }
    // The component that was split off accepts edges.
    let edge = Edge::new(6, 9, SE2::new(2.7, 0.8, 0.3), Matrix3::identity(), EdgeKind::Landmark);
    solver.add_edge(edge).unwrap();
    solver.update();
    solver.finish();
    assert!(distance_from_fresh(&solver).0 < 1e-9);
    assert!(solver.estimate(6).between(&before[6]).log().amax() < 1e-12, "the new gauge is held");
    // It joins the rest again.
    solver.add_edge(bridge).unwrap();
    solver.update();
    assert_eq!(solver.parts(), 1);
    solver.finish();
    assert!(distance_from_fresh(&solver).0 < 1e-9);
    assert_ne!(solver.estimate(9), before[9]);
}

/// The later component moves to the earlier one, however far apart their frames are, whichever way the edge points.
#[test]
fn sessions_with_frames_of_their_own_are_joined_rigidly() {
    for reverse in [false, true] {
        let (mut solver, _) = line(20);
        let start = solver.poses();
        solver.add_pose(SE2::new(1000.0, -500.0, 3.0)).unwrap();
        for node in start + 1..start + 20 {
            solver.add_pose(SE2::identity()).unwrap();
            let step = SE2::new(1.0, 0.0, 0.1);
            solver
                .add_edge(Edge::new(node - 1, node, step, Matrix3::identity(), EdgeKind::Odometry))
                .unwrap();
            solver.update();
        }
        assert_eq!(solver.parts(), 2);
        let measured = SE2::new(0.5, 0.0, 3.0);
        let edge = if reverse {
            Edge::new(start + 10, 3, measured.inverse(), Matrix3::identity(), EdgeKind::Landmark)
        } else {
            Edge::new(3, start + 10, measured, Matrix3::identity(), EdgeKind::Landmark)
        };
        solver.add_edge(edge).unwrap();
        let report = solver.update();
        assert!(report.relinearised == 0 && report.linearised < 5, "{report:?}");
        assert!(solver.cost() < 1e-20, "{}", solver.cost());
        assert!(
            solver.estimate(3).between(&solver.estimate(start + 10)).between(&measured).log().amax() < 1e-9
        );
        assert_eq!(solver.estimate(0), SE2::identity());
    }
}

#[test]
fn edges_that_cannot_be_taken_back_are_named() {
    let (mut solver, ids) = line(3);
    let unknown = solver.remove_edge(EdgeId(77)).unwrap_err();
    assert_eq!(unknown.to_string(), "edge 77 cannot be removed: no edge with this number was ever added");
    solver.remove_edge(ids[1]).unwrap();
    let twice = solver.remove_edge(ids[1]).unwrap_err();
    assert_eq!(twice.to_string(), "edge 1 cannot be removed: it was removed before; add it again first");
    let missing = Edge::new(0, 3, SE2::identity(), Matrix3::identity(), EdgeKind::Odometry);
    let missing = solver.add_edge(missing).unwrap_err();
    assert_eq!(missing, IncrementalError::Problem(ProblemError::MissingNode { edge: 2, node: 3, nodes: 3 }));
    let indefinite = Edge::new(0, 1, SE2::identity(), -Matrix3::identity(), EdgeKind::Odometry);
    assert!(solver.add_edge(indefinite).unwrap_err().to_string().contains("indefinite"));
    assert!(solver.add_pose(SE2::new(f64::NAN, 0.0, 0.0)).is_err());
    for options in [
        IncrementalOptions { propagate: -1.0, ..IncrementalOptions::default() },
        IncrementalOptions { relinearise_rotation: f64::NAN, ..IncrementalOptions::default() },
        IncrementalOptions { relinearise_every: 0, ..IncrementalOptions::default() },
    ] {
        assert!(IncrementalSolver::<SE2, 3>::new(options).is_err());
    }
}

#[test]
fn memory_does_not_grow_with_removed_edges() {
    let (mut solver, _) = line(200);
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut churn = |solver: &mut IncrementalSolver<SE2, 3>, times: usize| {
        for _ in 0..times {
            let a = random.random_range(0..90_usize);
            let b = 100 + random.random_range(0..90_usize);
            let measured = solver.estimate(a).between(&solver.estimate(b));
            let edge = Edge::new(a, b, measured, Matrix3::identity(), EdgeKind::Landmark);
            let id = solver.add_edge(edge).unwrap();
            solver.update();
            solver.remove_edge(id).unwrap();
            solver.update();
        }
        solver.bytes()
    };
    let early = churn(&mut solver, 300);
    let late = churn(&mut solver, 3000);
    assert!(late < early + early / 4, "{early} bytes became {late}");
}

/// A direction that no edge measures is held and named, and released when an edge measures it.
#[test]
fn undetermined_directions_are_held_and_named() {
    let (mut solver, _) = line(4);
    let node = solver.add_pose(SE2::identity()).unwrap();
    let mut blind = Matrix3::identity();
    blind[(2, 2)] = 0.0;
    solver.add_edge(Edge::new(3, node, SE2::new(1.0, 0.0, 0.0), blind, EdgeKind::Landmark)).unwrap();
    let report = solver.update();
    assert_eq!(report.undetermined, [node]);
    assert!(solver.cost() < 1e-20);
    solver
        .add_edge(Edge::new(2, node, SE2::new(2.0, 0.1, 0.7), Matrix3::identity(), EdgeKind::Landmark))
        .unwrap();
    assert!(solver.update().undetermined.is_empty());
    solver.finish();
    assert!(distance_from_fresh(&solver).0 < 1e-8);
}

/// A grossly false edge folds the map. After its removal the map is as without it.
#[test]
fn a_false_edge_leaves_no_trace() {
    let mut world =
        World::<SE2, 3>::new(3, 0.02, |random| SE2::new(1.0, 0.0, random.random_range(-0.4..0.4)));
    let mut solver = IncrementalSolver::new(IncrementalOptions::default()).unwrap();
    solver.add_pose(SE2::identity()).unwrap();
    for _ in 0..100 {
        let node = world.grow();
        solver.add_pose(SE2::identity()).unwrap();
        solver.add_edge(world.measure(node - 1, node, EdgeKind::Odometry)).unwrap();
        if node.is_multiple_of(7) {
            let earlier = world.any(node - 1);
            solver.add_edge(world.measure(earlier, node, EdgeKind::Landmark)).unwrap();
        }
        solver.update();
    }
    let wrong = Edge::new(4, 95, SE2::new(0.3, 0.1, 1.0), Matrix3::identity() * 2500.0, EdgeKind::Landmark);
    let id = solver.add_edge(wrong).unwrap();
    for _ in 0..5 {
        solver.update();
    }
    let bad = solver.cost();
    solver.remove_edge(id).unwrap();
    solver.update();
    let finish = solver.finish();
    let (distance, cost, optimum) = distance_from_fresh(&solver);
    assert!(finish.converged && distance < 1e-8, "{distance} {finish:?}");
    assert!(bad > 10.0 * cost && cost < 1.000_001 * optimum);
}

#[test]
fn kernels_weigh_edges_here_too() {
    let (mut solver, _) = line(12);
    let mut edge = Edge::new(0, 11, SE2::new(3.0, 3.0, 1.0), Matrix3::identity(), EdgeKind::Landmark);
    edge.kernel = Some(Kernel::Cauchy(1.0));
    solver.add_edge(edge).unwrap();
    solver.update();
    let finish = solver.finish();
    let edges = solver.edges().into_iter().map(|(_, edge)| edge).collect();
    let batch = optimize(&Problem::new(solver.estimates(), edges).unwrap(), &Options::default());
    assert!(
        finish.converged && (finish.cost - batch.cost).abs() < 1e-9 * batch.cost,
        "{finish:?} {}",
        batch.cost
    );
}

/// Long excursions with loops at their ends that later closures swing as a whole. Returns the largest gap to the optimum over
/// all steps, as a share, and the number of relinearised poses.
fn swing(options: IncrementalOptions) -> (f64, usize) {
    let (mut worst, mut relinearised) = (0.0_f64, 0);
    for seed in 0..6 {
        let mut world =
            World::<SE2, 3>::new(seed, 0.03, |random| SE2::new(1.0, 0.0, random.random_range(-0.6..0.6)));
        let mut solver = IncrementalSolver::new(options).unwrap();
        solver.add_pose(SE2::identity()).unwrap();
        for _ in 0..150 {
            let node = world.grow();
            solver.add_pose(SE2::identity()).unwrap();
            solver.add_edge(world.measure(node - 1, node, EdgeKind::Odometry)).unwrap();
            if node > 20 && node.is_multiple_of(10) {
                let earlier = world.any(node - 10);
                solver.add_edge(world.measure(earlier, node, EdgeKind::Landmark)).unwrap();
            }
            relinearised += solver.update().relinearised;
            let (_, cost, optimum) = distance_from_fresh(&solver);
            worst = worst.max((cost - optimum) / optimum.max(0.01));
        }
    }
    (worst, relinearised)
}

/// Fewer relinearisations cost accuracy: little with the default share, as much as a large share allows.
#[test]
fn the_share_of_linearisation_errors_trades_work_for_accuracy() {
    let with = |linearisation_error| {
        let (gap, relinearised) =
            swing(IncrementalOptions { linearisation_error, ..IncrementalOptions::default() });
        println!("share {linearisation_error}: gap {gap:.1e}, {relinearised} relinearised");
        (gap, relinearised)
    };
    let (thresholds_alone, all) = with(0.0);
    let (default, fewer) = with(IncrementalOptions::default().linearisation_error);
    let (loose, few) = with(1e-3);
    assert!(thresholds_alone < 5e-4 && default < 2.0 * thresholds_alone, "{thresholds_alone:e} {default:e}");
    assert!(default < loose && loose < 0.1, "{default:e} {loose:e}");
    assert!(few < fewer && fewer < all, "{few} {fewer} {all}");
}

/// A component that loses its connection gets a gauge; otherwise its equations would be singular.
#[test]
fn a_part_that_is_split_off_stays_determined() {
    let (mut solver, ids) = line(30);
    let loop_edge =
        Edge::new(12, 25, SE2::new(9.0, 3.0, 1.0), Matrix3::identity() * 100.0, EdgeKind::Landmark);
    solver.add_edge(loop_edge).unwrap();
    solver.update();
    solver.remove_edge(ids[8]).unwrap();
    let report = solver.update();
    assert!(report.undetermined.is_empty(), "{report:?}");
    assert_eq!(report.splits, [Split { gauge: 9, nodes: 21 }]);
    solver.finish();
    assert!(distance_from_fresh(&solver).0 < 1e-8);
}

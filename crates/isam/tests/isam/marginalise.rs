//! Marginalised poses: what they leave is exact where the model is linear, and what reaches them is refused by name.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use nalgebra::Matrix3;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::connectivity::connected_components;
use posecut_isam::{
    EdgeId, IncrementalError, IncrementalGroup, IncrementalOptions, IncrementalSolver, Split,
};
use posecut_optimize::{Edge, EdgeKind, Marginals, Problem};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;

use crate::growing::{World, planar, refine, spatial};
use crate::incremental::line;
use crate::lagged::{apart_on_live, frozen, play, session};
use crate::noisy_walk::bits;

fn check_linear<G: IncrementalGroup<DOF>, const DOF: usize>(seed: u64, step: fn(&mut ChaCha8Rng) -> G) {
    let session = session::<G, DOF>(seed, 0.02, [80, 12], step);
    let mut full = IncrementalSolver::<G, DOF>::new(frozen()).unwrap();
    play(&mut full, &session, |_, _| {});
    let mut lagged =
        IncrementalSolver::<G, DOF>::new(IncrementalOptions { lag: Some(20), ..frozen() }).unwrap();
    play(&mut lagged, &session, |solver, node| {
        let cost = solver.cost();
        assert!(solver.live_poses().len() <= 24 && cost.is_finite(), "{node}");
    });
    assert!(lagged.absorbed_edges() > 60 && !lagged.prior_sizes().is_empty());
    let apart = apart_on_live(&lagged, &full.estimates());
    assert!(apart < 1e-9, "seed {seed}: {apart:e}");
    let (here, there) = (lagged.covariance(79).unwrap(), full.covariance(79).unwrap());
    assert!((here - there).amax() < 1e-9 * there.amax(), "{here} {there}");
}

#[test]
fn with_frozen_points_of_linearisation_a_lag_changes_no_remaining_pose_and_no_covariance() {
    for seed in 0..6 {
        check_linear::<SE2, 3>(seed, planar);
        check_linear::<SE3, 6>(seed, spatial);
    }
}

/// The covariances of the batch solver, at the same poses.
#[test]
fn covariances_are_those_of_the_batch_solver() {
    let session = session::<SE2, 3>(3, 1e-3, [60, 10], planar);
    let mut solver = IncrementalSolver::<SE2, 3>::new(IncrementalOptions::default()).unwrap();
    play(&mut solver, &session, |_, _| {});
    solver.finish();
    let edges: Vec<_> = session.edges.iter().map(|(_, edge)| *edge).collect();
    let weights = vec![1.0; edges.len()];
    let poses = solver.estimates();
    let problem = Problem::new(poses.clone(), edges).unwrap();
    let mut marginals = Marginals::new(&problem, &poses, &weights);
    let mut lagged = IncrementalSolver::<SE2, 3>::new(IncrementalOptions {
        lag: Some(15),
        ..IncrementalOptions::default()
    })
    .unwrap();
    play(&mut lagged, &session, |_, _| {});
    lagged.finish();
    for node in [59, 50, 47] {
        let expected = marginals.poses(&[node])[0].unwrap();
        let found = solver.covariance(node).unwrap();
        assert!((found - expected).amax() < 1e-9 * expected.amax(), "{node}: {found} {expected}");
        // The marginalised past is linearised at earlier estimates: equal to the noise.
        let found = lagged.covariance(node).unwrap();
        assert!((found - expected).amax() < 1e-2 * expected.amax(), "{node}: {found} {expected}");
    }
    assert_eq!(solver.covariance(0), Some(Matrix3::zeros()));
    assert!(lagged.covariance(5).is_none() && lagged.covariance(60).is_none());
}

/// What remains of a random sequence: edges that were not removed, the marginalised past included.
struct Reference<G, const DOF: usize> {
    edges: Vec<(EdgeId, Edge<G, DOF>)>,
    removed: Vec<Edge<G, DOF>>,
}

/// Compares relative poses within components with a dense solution of all edges, those of the past included.
fn check_against_dense<G: IncrementalGroup<DOF>, const DOF: usize>(
    solver: &mut IncrementalSolver<G, DOF>,
    reference: &Reference<G, DOF>,
    truth: &[G],
) -> Result<(), TestCaseError> {
    let report = solver.finish();
    prop_assert!(report.converged, "{:?}", report);
    let edges: Vec<_> = reference.edges.iter().map(|(_, edge)| *edge).collect();
    let components = connected_components(truth.len(), edges.iter().map(|edge| (edge.from, edge.to)));
    prop_assert_eq!(components.len(), solver.parts());
    let gauges: Vec<usize> = components.iter().map(|component| component.nodes[0]).collect();
    let dense = refine(truth.to_vec(), &edges, &gauges);
    for component in &components {
        let live: Vec<usize> =
            component.nodes.iter().copied().filter(|&node| !solver.is_marginalised(node)).collect();
        for &node in &live {
            let found = solver.estimate(live[0]).between(&solver.estimate(node));
            let expected = dense[live[0]].between(&dense[node]);
            let apart = found.between(&expected).log().amax();
            prop_assert!(apart < 1e-6, "pose {} is {:e} away", node, apart);
        }
    }
    Ok(())
}

/// Adds, removes and marginalises at random, with noise so small that the model is linear to 1e-8.
fn come_go_and_pass<G: IncrementalGroup<DOF>, const DOF: usize>(
    seed: u64,
    steps: usize,
    step: fn(&mut ChaCha8Rng) -> G,
) -> Result<(), TestCaseError> {
    let mut world = World::<G, DOF>::new(seed, 1e-5, step);
    let mut solver = IncrementalSolver::<G, DOF>::new(IncrementalOptions::default()).unwrap();
    solver.add_pose(world.truth[0]).unwrap();
    let mut reference = Reference { edges: Vec::new(), removed: Vec::new() };
    let add = |solver: &mut IncrementalSolver<G, DOF>, reference: &mut Reference<G, DOF>, edge| {
        reference.edges.push((solver.add_edge(edge).unwrap(), edge));
    };
    for _ in 0..steps {
        match world.any(12) {
            0..=4 => {
                let node = world.grow();
                // Every tenth pose begins a session of its own.
                solver.add_pose(world.truth[node / 2]).unwrap();
                if world.any(10) > 0 && !solver.is_marginalised(node - 1) {
                    let edge = world.measure(node - 1, node, EdgeKind::Odometry);
                    add(&mut solver, &mut reference, edge);
                }
            }
            5..=7 => {
                let live = solver.live_poses().to_vec();
                let (a, b) = (live[world.any(live.len())], live[world.any(live.len())]);
                if a != b {
                    let edge = world.measure(a, b, EdgeKind::Landmark);
                    add(&mut solver, &mut reference, edge);
                }
            }
            8 if !reference.edges.is_empty() => {
                let place = world.any(reference.edges.len());
                let (id, edge) = reference.edges[place];
                match solver.remove_edge(id) {
                    Ok(_) => {
                        reference.edges.swap_remove(place);
                        reference.removed.push(edge);
                    }
                    Err(error) => {
                        let Edge { from, to, .. } = edge;
                        prop_assert_eq!(error, IncrementalError::AbsorbedEdge { edge: id.0, from, to });
                    }
                }
            }
            9 if !reference.removed.is_empty() => {
                let edge = reference.removed.swap_remove(world.any(reference.removed.len()));
                if solver.is_marginalised(edge.from) || solver.is_marginalised(edge.to) {
                    let error = solver.add_edge(edge).unwrap_err();
                    prop_assert!(matches!(error, IncrementalError::MarginalisedPose { .. }), "{}", error);
                } else {
                    add(&mut solver, &mut reference, edge);
                }
            }
            10 => {
                let live = solver.live_poses().to_vec();
                let chosen: Vec<usize> = (0..=world.any(3)).map(|_| live[world.any(live.len())]).collect();
                if world.any(2) == 0 {
                    solver.update();
                }
                if let Err(error) = solver.marginalise(&chosen) {
                    prop_assert!(matches!(error, IncrementalError::FixedPose { .. }), "{}", error);
                }
            }
            _ => {
                solver.update();
            }
        }
        if world.any(12) == 0 {
            check_against_dense(&mut solver, &reference, &world.truth)?;
        }
    }
    check_against_dense(&mut solver, &reference, &world.truth)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn what_marginalised_poses_leave_is_what_their_edges_said(seed: u64, steps in 1_usize..150) {
        come_go_and_pass::<SE2, 3>(seed, steps, planar)?;
        come_go_and_pass::<SE3, 6>(seed, steps, spatial)?;
    }
}

/// What decides the next results: poses, edges, components and priors.
type State = (Vec<Vec<u64>>, Vec<EdgeId>, usize, Vec<usize>, Vec<usize>);

fn state(solver: &IncrementalSolver<SE2, 3>) -> State {
    let poses = solver.estimates().iter().map(bits).collect();
    let ids = solver.edges().into_iter().map(|(id, _)| id).collect();
    (poses, ids, solver.parts(), solver.live_poses().to_vec(), solver.prior_sizes())
}

#[test]
fn what_reaches_into_the_past_is_refused_by_name_and_changes_nothing() {
    let (mut solver, ids) = line(8);
    let before = (solver.estimates(), solver.cost());
    solver.marginalise(&[3, 4, 3]).unwrap();
    assert_eq!(before, (solver.estimates(), solver.cost()), "marginalisation moves no pose");
    let state_before = state(&solver);
    assert_eq!(state_before.3, [0, 1, 2, 5, 6, 7]);
    assert_eq!((solver.absorbed_edges(), solver.edge_count(), solver.prior_sizes()), (3, 4, vec![2]));
    for id in [2, 3, 4] {
        let error = solver.remove_edge(ids[id]).unwrap_err();
        let said = format!(
            "edge {id} from pose {id} to pose {} cannot be removed: it is part of the marginalised past; remove an edge before its poses are marginalised, or marginalise later",
            id + 1
        );
        assert_eq!(error.to_string(), said);
    }
    let late = Edge::new(7, 4, SE2::identity(), Matrix3::identity(), EdgeKind::Landmark);
    let error = solver.add_edge(late).unwrap_err();
    assert_eq!(error, IncrementalError::MarginalisedPose { edge: 7, from: 7, to: 4, pose: 4 });
    assert!(
        error
            .to_string()
            .starts_with("edge 7 from pose 7 to pose 4 cannot be added: pose 4 was marginalised;")
    );
    for (poses, error, said) in [
        (vec![5, 8], IncrementalError::UnknownPose { pose: 8, poses: 8 }, "there are only 8 poses"),
        (vec![5, 3], IncrementalError::MarginalisedTwice { pose: 3 }, "it was marginalised before"),
        (vec![5, 0], IncrementalError::FixedPose { pose: 0, held: false }, "gauge that gives its component"),
    ] {
        let found = solver.marginalise(&poses).unwrap_err();
        assert_eq!(found, error);
        assert!(found.to_string().contains(said), "{found}");
    }
    let held = solver.add_held_pose(SE2::identity()).unwrap();
    assert_eq!(solver.marginalise(&[held]), Err(IncrementalError::FixedPose { pose: held, held: true }));
    assert_eq!(solver.marginalise(&[]), Ok(()));
    let after = state(&solver);
    assert_eq!(
        (&after.0[..8], &after.1, &after.3[..6], &after.4),
        (&state_before.0[..], &state_before.1, &state_before.3[..], &state_before.4)
    );
    // The line still hangs together, and bends as before.
    solver.update();
    let edge = Edge::new(7, 1, SE2::new(-5.0, 2.0, -0.6), Matrix3::identity(), EdgeKind::Landmark);
    solver.add_edge(edge).unwrap();
    solver.finish();
    let (mut full, _) = line(8);
    full.add_edge(edge).unwrap();
    full.finish();
    assert!(apart_on_live(&solver, &[full.estimates(), vec![SE2::identity()]].concat()) < 0.05);
    assert!(solver.covariance(4).is_none());
}

/// A pose at the end of a line tells nothing about the others; its cost remains.
#[test]
fn a_marginalised_end_leaves_no_prior() {
    let (mut solver, _) = line(4);
    solver.marginalise(&[3]).unwrap();
    assert!(solver.prior_sizes().is_empty());
    // All poses of a component but its gauge.
    solver.marginalise(&[1, 2]).unwrap();
    assert!(solver.prior_sizes().is_empty() && solver.edge_count() == 0 && solver.parts() == 1);
    let next = solver.add_pose(SE2::identity()).unwrap();
    solver
        .add_edge(Edge::new(0, next, SE2::new(1.0, 2.0, 0.3), Matrix3::identity(), EdgeKind::Odometry))
        .unwrap();
    solver.update();
    assert!(solver.finish().converged && solver.cost() < 1e-20);
}

/// A component that loses its connection gets a live pose as its gauge, though a marginalised one has a lower number.
#[test]
fn a_marginalised_pose_is_no_gauge() {
    let mut solver = IncrementalSolver::new(IncrementalOptions::default()).unwrap();
    for _ in 0..6 {
        solver.add_pose(SE2::identity()).unwrap();
    }
    let step = SE2::new(1.0, 0.0, 0.1);
    let mut join = |from, to| {
        solver.add_edge(Edge::new(from, to, step, Matrix3::identity(), EdgeKind::Odometry)).unwrap()
    };
    let _ = join(0, 1);
    let bridge = join(1, 5);
    let _ = [join(5, 2), join(2, 3), join(3, 4)];
    solver.update();
    solver.marginalise(&[2]).unwrap();
    solver.remove_edge(bridge).unwrap();
    let report = solver.update();
    assert_eq!(report.splits, [Split { gauge: 3, nodes: 3 }]);
    assert!(report.undetermined.is_empty() && solver.finish().converged);
    assert!(solver.covariance(5).unwrap().amax() > 0.0);
}

/// The cost counts the past: marginalisation does not change it, and later costs are those of all edges.
#[test]
fn the_cost_of_the_past_remains() {
    let session = session::<SE2, 3>(5, 0.02, [40, 10], planar);
    let mut solver = IncrementalSolver::<SE2, 3>::new(IncrementalOptions::default()).unwrap();
    play(&mut solver, &session, |_, _| {});
    solver.finish();
    let cost = solver.cost();
    solver.marginalise(&(1..25).collect::<Vec<_>>()).unwrap();
    assert!((solver.cost() - cost).abs() < 1e-9 * cost, "{} {cost}", solver.cost());
    let report = solver.finish();
    assert!(report.converged && (report.cost - cost).abs() < 1e-6 * cost, "{report:?} {cost}");
}

/// A session that lost its first poses is joined to another one: it moves as a whole, and the prior with it.
#[test]
fn a_session_with_a_marginalised_past_is_joined_rigidly() {
    let join = |marginalise: bool| {
        let (mut solver, _) = line(12);
        let start = solver.add_pose(SE2::new(500.0, -900.0, 2.0)).unwrap();
        for node in start + 1..start + 10 {
            solver.add_pose(SE2::identity()).unwrap();
            let step = SE2::new(1.0, 0.1, -0.2);
            solver
                .add_edge(Edge::new(node - 1, node, step, Matrix3::identity(), EdgeKind::Odometry))
                .unwrap();
            solver.update();
        }
        let closure =
            Edge::new(start, start + 9, SE2::new(7.0, -4.0, -1.7), Matrix3::identity(), EdgeKind::Landmark);
        solver.add_edge(closure).unwrap();
        solver.finish();
        if marginalise {
            solver.marginalise(&(start + 1..start + 7).collect::<Vec<_>>()).unwrap();
        }
        for (from, to, measured) in
            [(3, start + 8, SE2::new(0.5, 0.2, 2.0)), (5, start + 9, SE2::new(-2.0, 1.5, 1.6))]
        {
            solver
                .add_edge(Edge::new(from, to, measured, Matrix3::identity() * 0.01, EdgeKind::Landmark))
                .unwrap();
            solver.update();
        }
        assert!(solver.finish().converged);
        (solver.estimates(), solver.cost())
    };
    let ((lagged, cost), (full, full_cost)) = (join(true), join(false));
    for node in (0..13).chain(19..22) {
        let apart = lagged[node].between(&full[node]).log().amax();
        assert!(apart < 2e-3, "{node}: {apart:e}");
    }
    assert!((cost - full_cost).abs() < 1e-3 * full_cost, "{cost} {full_cost}");
    // The past moved along.
    assert!(lagged[13].between(&lagged[14]).between(&full[13].between(&full[14])).log().amax() < 0.05);
}

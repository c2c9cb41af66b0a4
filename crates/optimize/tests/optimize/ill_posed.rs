//! Graphs that the edges hardly determine: they are solved with damping if necessary, and reported.

#![allow(clippy::unwrap_used, reason = "functions of tests may panic")]

use nalgebra::{Matrix3, Vector3};
use posecut_geometry::{LieGroup, SE2};
use posecut_optimize::{Edge, EdgeKind, Initialisation, Options, Problem, Solution, optimize};

/// Two straight sessions of `length` nodes each, the second one 5 m beside the first.
fn two_sessions(length: usize, joins: &[(usize, usize, Matrix3<f64>)]) -> Problem<SE2, 3> {
    let pose = |session: usize, index: usize| SE2::new(index as f64, 5.0 * session as f64, 0.0);
    let node = |session: usize, index: usize| session * length + index;
    let mut edges = Vec::new();
    for session in 0..2 {
        for index in 1..length {
            let (from, to) = (node(session, index - 1), node(session, index));
            let step = SE2::new(1.0, 0.0, 0.0);
            edges.push(Edge::new(from, to, step, Matrix3::identity() * 100.0, EdgeKind::Odometry));
        }
    }
    for &(a, b, information) in joins {
        let measured = pose(0, a).between(&pose(1, b));
        edges.push(Edge::new(a, node(1, b), measured, information, EdgeKind::Landmark));
    }
    // The second session starts far away, in a frame of its own.
    let own = SE2::new(30.0, -20.0, 2.0);
    let poses = (0..2)
        .flat_map(|session| (0..length).map(move |index| (session, index)))
        .map(
            |(session, index)| {
                if session == 0 { pose(0, index) } else { own.compose(&SE2::new(index as f64, 0.0, 0.0)) }
            },
        )
        .collect();
    Problem::new(poses, edges).unwrap()
}

fn assert_sound(solution: &Solution<SE2>, problem: &Problem<SE2, 3>) {
    assert!(solution.converged, "{:?}", solution.components);
    assert!(solution.chi_square < 1e-8, "{}", solution.chi_square);
    assert!(solution.poses.iter().flat_map(LieGroup::components).all(f64::is_finite));
    // Damping moves poses no further than the measurements and the given poses reach.
    let reach = problem.poses().iter().map(|pose| pose.translation.norm()).fold(0.0, f64::max);
    assert!(solution.poses.iter().all(|pose| pose.translation.norm() < 10.0 * reach));
}

const ALL: [Initialisation; 4] =
    [Initialisation::Given, Initialisation::SpanningTree, Initialisation::Chordal, Initialisation::Best];

#[test]
fn one_edge_joins_two_sessions() {
    let problem = two_sessions(20, &[(10, 10, Matrix3::identity())]);
    for initialisation in ALL {
        let solution = optimize(&problem, &Options { initialisation, ..Options::default() });
        assert_sound(&solution, &problem);
        assert_eq!(solution.components.len(), 1);
        assert!(solution.components[0].undetermined.is_none());
        assert!((solution.poses[39].translation - Vector3::new(19.0, 5.0, 0.0).xy()).norm() < 1e-4);
    }
}

#[test]
fn edges_that_measure_positions_alone_leave_the_angle_between_sessions_and_say_so() {
    let position = Matrix3::from_diagonal(&Vector3::new(4.0, 4.0, 0.0));
    let problem = two_sessions(20, &[(10, 10, position)]);
    assert_eq!(problem.semidefinite().len(), 1);
    for initialisation in ALL {
        let solution = optimize(&problem, &Options { initialisation, ..Options::default() });
        assert_sound(&solution, &problem);
    }
    let given = optimize(&problem, &Options { initialisation: Initialisation::Given, ..Options::default() });
    let (node, _) = given.components[0].undetermined.unwrap();
    assert!(node >= 20, "{node}");
    // Two such edges determine the relative pose of the sessions.
    let problem = two_sessions(20, &[(2, 2, position), (17, 17, position)]);
    let solution = optimize(&problem, &Options::default());
    assert_sound(&solution, &problem);
    assert!((solution.poses[39].translation - Vector3::new(19.0, 5.0, 0.0).xy()).norm() < 1e-4);
}

#[test]
fn information_of_wildly_different_sizes_is_solved() {
    for size in [1e-9, 1e-6, 1e6] {
        let weak = Matrix3::from_diagonal(&Vector3::new(size, 1.0, size));
        let problem = two_sessions(30, &[(3, 3, weak), (25, 25, weak * 1e-3)]);
        for initialisation in ALL {
            let solution = optimize(&problem, &Options { initialisation, ..Options::default() });
            assert_sound(&solution, &problem);
        }
    }
}

#[test]
fn sessions_that_nothing_joins_are_parts_of_their_own() {
    let problem = two_sessions(20, &[]);
    let solution = optimize(&problem, &Options::default());
    assert_sound(&solution, &problem);
    assert_eq!(
        solution.components.iter().map(|part| (part.gauge, part.nodes)).collect::<Vec<_>>(),
        [(0, 20), (20, 20)]
    );
    assert_eq!(solution.poses[20], problem.poses()[20]);
}

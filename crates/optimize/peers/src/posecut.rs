//! posecut-optimize itself, through its library, with its defaults.

use std::time::Instant;

use nalgebra::SMatrix;
use posecut_geometry::{SE2, SE3};
use posecut_optimize::{Edge, EdgeKind, Initialisation, Options, PoseGroup, Problem, optimize};

use crate::graph::{Graph, Outcome};

/// Solves from the start that posecut-optimize chooses.
pub fn solve(graph: &Graph, _: &str) -> Outcome {
    solve_from(graph, Initialisation::Best)
}

/// Solves from the poses of the file, as the other solvers do.
pub fn solve_given(graph: &Graph, _: &str) -> Outcome {
    solve_from(graph, Initialisation::Given)
}

fn solve_from(graph: &Graph, initialisation: Initialisation) -> Outcome {
    if graph.planar {
        run::<SE2, 3>(graph, initialisation)
    } else {
        run::<SE3, 6>(graph, initialisation)
    }
}

fn run<G: PoseGroup<DOF>, const DOF: usize>(graph: &Graph, initialisation: Initialisation) -> Outcome {
    let pose = |components: &Vec<f64>| G::from_components(components).expect("a pose");
    let edge = |edge: &crate::graph::Edge| {
        let information = SMatrix::<f64, DOF, DOF>::from_fn(|row, column| edge.information[row][column]);
        let kind = if edge.to == edge.from + 1 { EdgeKind::Odometry } else { EdgeKind::Landmark };
        Edge::new(edge.from, edge.to, pose(&edge.measurement), information, kind)
    };
    let poses = graph.poses.iter().map(pose).collect();
    let problem = Problem::new(poses, graph.edges.iter().map(edge).collect()).expect("a graph that can be optimised");
    let options = Options { initialisation, ..Options::default() };
    let start = Instant::now();
    let solution = optimize(&problem, &options);
    let seconds = start.elapsed().as_secs_f64();
    let poses = solution.poses.iter().map(|pose| pose.components().to_vec()).collect();
    Outcome { seconds, poses, iterations: Some(solution.iterations) }
}

//! apex-solver: Gauss-Newton with the tolerances of its own benchmark program.

use std::time::Instant;

use apex_solver::apex_manifolds::ManifoldType;
use apex_solver::apex_manifolds::se2::SE2;
use apex_solver::apex_manifolds::se3::SE3;
use apex_solver::core::noise::RepairStrategy;
use apex_solver::core::problem::Problem;
use apex_solver::factors::pose::{BetweenFactor, PriorFactor};
use apex_solver::optimizer::GaussNewton;
use apex_solver::optimizer::gauss_newton::GaussNewtonConfig;
use apex_solver::JacobianMode;
use nalgebra_apex::{DMatrix, DVector, Quaternion, Vector3};

use crate::graph::{Graph, Outcome};

fn planar(m: &[f64]) -> SE2 {
    SE2::from_xy_angle(m[0], m[1], m[2])
}

fn spatial(m: &[f64]) -> SE3 {
    SE3::from_translation_quaternion(Vector3::new(m[0], m[1], m[2]), Quaternion::new(m[6], m[3], m[4], m[5]))
}

pub fn solve(graph: &Graph, _: &str) -> Outcome {
    let mut problem = Problem::new(JacobianMode::Sparse);
    let mut keys = Vec::new();
    for pose in &graph.poses {
        keys.push(if graph.planar {
            problem.add_variable(ManifoldType::SE2, DVector::from_column_slice(pose))
        } else {
            // Scalar part first.
            let value = [pose[0], pose[1], pose[2], pose[6], pose[3], pose[4], pose[5]];
            problem.add_variable(ManifoldType::SE3, DVector::from_column_slice(&value))
        });
    }
    if graph.planar {
        problem.add_residual_block(&[keys[0]], Box::new(PriorFactor::new(planar(&graph.poses[0]))), None);
    } else {
        problem.add_residual_block(&[keys[0]], Box::new(PriorFactor::new(spatial(&graph.poses[0]))), None);
    }
    for edge in &graph.edges {
        let size = edge.information.len();
        let information = DMatrix::from_fn(size, size, |row, column| edge.information[row][column]);
        let noise = RepairStrategy::Clamp.build(information).expect("finite information").0;
        let ends = [keys[edge.from], keys[edge.to]];
        if graph.planar {
            let factor = BetweenFactor::new(planar(&edge.measurement));
            problem.add_residual_block_with_noise(&ends, Box::new(factor), None, noise);
        } else {
            let factor = BetweenFactor::new(spatial(&edge.measurement));
            problem.add_residual_block_with_noise(&ends, Box::new(factor), None, noise);
        }
    }
    let config = GaussNewtonConfig::new()
        .with_max_iterations(100)
        .with_cost_tolerance(1e-4)
        .with_parameter_tolerance(1e-4)
        .with_gradient_tolerance(1e-10);
    let mut solver = GaussNewton::with_config(config);
    let start = Instant::now();
    let result = solver.optimize(&mut problem);
    let seconds = start.elapsed().as_secs_f64();
    let Ok(result) = result else {
        return Outcome { seconds, poses: graph.poses.clone(), iterations: None };
    };
    let pose = |&key| {
        let v = result.parameters[key].to_dvector();
        if graph.planar { vec![v[0], v[1], v[2]] } else { vec![v[0], v[1], v[2], v[4], v[5], v[6], v[3]] }
    };
    Outcome { seconds, poses: keys.iter().map(pose).collect(), iterations: Some(result.iterations) }
}

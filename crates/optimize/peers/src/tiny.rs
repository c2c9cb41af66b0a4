//! tiny-solver: Gauss-Newton with its defaults. Its reader ignores information matrices and adds a Huber kernel. Here its
//! factors are multiplied by the root of the information, without a kernel.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use nalgebra_tiny::{DMatrix, DVector, RealField};
use tiny_solver::factors::{BetweenFactorSE2, BetweenFactorSE3, Factor};
use tiny_solver::manifold::se3::SE3Manifold;
use tiny_solver::{GaussNewtonOptimizer, Optimizer, Problem};

use crate::graph::{Graph, Outcome};

/// Counts the iterations by the lines of its log, since it reports them nowhere else.
struct IterationCounter;

static ITERATIONS: AtomicUsize = AtomicUsize::new(0);

impl log::Log for IterationCounter {
    fn enabled(&self, _: &log::Metadata<'_>) -> bool {
        true
    }

    fn log(&self, record: &log::Record<'_>) {
        if record.target().starts_with("tiny_solver") && record.args().to_string().starts_with("iter:") {
            ITERATIONS.fetch_add(1, Ordering::Relaxed);
        }
    }

    fn flush(&self) {}
}

#[derive(Debug, Clone)]
struct Weighted<F> {
    inner: F,
    root: DMatrix<f64>,
}

impl<T: RealField, F: Factor<T>> Factor<T> for Weighted<F> {
    fn residual_func(&self, parameters: &[DVector<T>]) -> DVector<T> {
        self.root.map(|entry| T::from_f64(entry).expect("a real number")) * self.inner.residual_func(parameters)
    }
}

pub fn solve(graph: &Graph, _: &str) -> Outcome {
    let mut problem = Problem::new();
    let mut values = HashMap::new();
    let name = |id: usize| format!("x{id}");
    for (id, pose) in graph.poses.iter().enumerate() {
        let value = if graph.planar {
            DVector::from_column_slice(&[pose[2], pose[0], pose[1]])
        } else {
            problem.set_variable_manifold(&name(id), Arc::new(SE3Manifold));
            DVector::from_column_slice(&[pose[3], pose[4], pose[5], pose[6], pose[0], pose[1], pose[2]])
        };
        values.insert(name(id), value);
    }
    // Its logarithm in space puts the rotation first.
    let order: &[usize] = if graph.planar { &[0, 1, 2] } else { &[3, 4, 5, 0, 1, 2] };
    for edge in &graph.edges {
        let size = order.len();
        let information =
            DMatrix::from_fn(size, size, |row, column| edge.information[order[row]][order[column]]);
        let Some(factor) = information.cholesky() else { continue };
        let root = factor.l().transpose();
        let (from, to, m) = (name(edge.from), name(edge.to), &edge.measurement);
        if graph.planar {
            let inner = BetweenFactorSE2 { dx: m[0], dy: m[1], dtheta: m[2] };
            problem.add_residual_block(3, &[&from, &to], Box::new(Weighted { inner, root }), None);
        } else {
            let inner = BetweenFactorSE3 {
                dtx: m[0],
                dty: m[1],
                dtz: m[2],
                dqx: m[3],
                dqy: m[4],
                dqz: m[5],
                dqw: m[6],
            };
            problem.add_residual_block(6, &[&from, &to], Box::new(Weighted { inner, root }), None);
        }
    }
    let first = values[&name(0)].clone();
    let prior = tiny_solver::factors::PriorFactor { v: first.clone() };
    problem.add_residual_block(first.len(), &[&name(0)], Box::new(prior), None);
    // The logger is set once; later repeats keep it.
    let _ = log::set_logger(&IterationCounter);
    log::set_max_level(log::LevelFilter::Trace);
    ITERATIONS.store(0, Ordering::Relaxed);
    let start = Instant::now();
    let result = GaussNewtonOptimizer::new().optimize(&problem, &values, None);
    let seconds = start.elapsed().as_secs_f64();
    let Some(result) = result else {
        return Outcome { seconds, poses: graph.poses.clone(), iterations: None };
    };
    let pose = |id: usize| {
        let v = &result[&name(id)];
        if graph.planar { vec![v[1], v[2], v[0]] } else { vec![v[4], v[5], v[6], v[0], v[1], v[2], v[3]] }
    };
    Outcome {
        seconds,
        poses: (0..graph.poses.len()).map(pose).collect(),
        iterations: Some(ITERATIONS.load(Ordering::Relaxed)),
    }
}

//! factrs: Gauss-Newton with its defaults.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use factrs::assign_symbols;
use factrs::core::{GaussNewton, SE2, SE3};
use factrs::containers::Values;
use factrs::optimizers::{BaseOptParams, OptObserver};
use factrs::traits::Optimizer;
use factrs::utils::load_g20;

use crate::graph::{Graph, Outcome};

assign_symbols!(X: SE2; Y: SE3);

struct IterationCounter(Arc<AtomicUsize>);

impl OptObserver for IterationCounter {
    fn on_step(&self, _: &Values, _: i64) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

pub fn solve(graph: &Graph, path: &str) -> Outcome {
    let (factors, start_values) = load_g20(path);
    let mut solver = GaussNewton::new(BaseOptParams { max_iterations: 200, ..Default::default() }, factors);
    let iterations = Arc::new(AtomicUsize::new(0));
    solver.add_observer(IterationCounter(Arc::clone(&iterations)));
    let start = Instant::now();
    let result = solver.optimize(start_values);
    let seconds = start.elapsed().as_secs_f64();
    let Ok(values) = result else {
        return Outcome { seconds, poses: graph.poses.clone(), iterations: None };
    };
    let pose = |id: usize| {
        let id = id as u32;
        if graph.planar {
            let pose: &SE2 = values.get_unchecked(factrs::symbols::X(id)).expect("every vertex");
            vec![pose.x(), pose.y(), pose.theta()]
        } else {
            let pose: &SE3 = values.get_unchecked(factrs::symbols::X(id)).expect("every vertex");
            let (t, q) = (pose.xyz(), pose.rot());
            vec![t[0], t[1], t[2], q.x(), q.y(), q.z(), q.w()]
        }
    };
    Outcome { seconds, poses: (0..graph.poses.len()).map(pose).collect(), iterations: Some(iterations.load(Ordering::Relaxed)) }
}

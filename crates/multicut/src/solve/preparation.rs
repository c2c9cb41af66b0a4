//! What precedes branch and cut: a good solution of small kernels, and a bound of dense ones.

use super::search::State;
use crate::bound::spreading::spread;
use crate::budget::Budget;
use crate::certificate::proof::Proof;
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::heuristics::annealing::anneal;

/// Largest kernel, in nodes, that is annealed, the work that this takes for each edge, also where the gap is wide, and the most
/// work.
const ANNEALED: usize = 400;
const ANNEALING: (u64, u64) = (1_500, 15_000);
const MOST_ANNEALING: u64 = 60_000_000;
/// Gap that counts as wide, as a share of the payment.
const WIDE: f64 = 0.02;

/// Smallest share of all pairs of nodes that edges join in a dense kernel.
const DENSE: f64 = 0.3;

/// Improves the solution of a small kernel by annealing before anything else, because all that follows relies on a good one.
pub(crate) fn prepare(graph: &SignedGraph, state: &mut State, seed: u64, budget: &mut Budget) {
    if state.is_closed() || graph.node_count() > ANNEALED || budget.is_over() {
        return;
    }
    // A wide gap means a long search, or none that ends.
    let wide = state.objective - state.bound > WIDE * (state.bound - graph.negative_sum());
    let each = if wide { ANNEALING.1 } else { ANNEALING.0 };
    let effort = (each * graph.edges().count() as u64).min(MOST_ANNEALING);
    let mut labels = state.labels.clone();
    anneal(graph, &mut labels, effort, seed, budget);
    state.offer(graph, labels);
}

/// Bounds a dense kernel by tight conflicts of its solution. There are too many of them to start anything else from.
pub(crate) fn bound_by_spreading(graph: &SignedGraph, state: &mut State, budget: &mut Budget) {
    let nodes = graph.node_count() as f64;
    let dense = graph.edges().count() as f64 >= DENSE * 0.5 * nodes * (nodes - 1.0);
    if state.is_closed() || !dense || budget.is_over() {
        return;
    }
    let kernel = Kernel::new(graph);
    // Integers round up.
    let target = state.objective - if kernel.integral { 0.999 } else { 0.5 * state.tolerance };
    if let Some(packing) = spread(&kernel, &state.labels, state.bound, target, budget) {
        state.raise(kernel.rounded(packing.bound), || Some(Proof::Packing(packing.conflicts)));
    }
}

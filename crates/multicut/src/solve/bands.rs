//! Kernels that a packing guided by a good multicut closes: long bands above all.

use super::search::State;
use crate::bound::rerouting::{Effort, reroute};
use crate::budget::Budget;
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::heuristics::band_order::band_order;
use crate::heuristics::kernighan_lin::kernighan_lin_with_joins;
use crate::heuristics::linear_arrangement::shorten;
use crate::heuristics::local_search::{Fusions, Polish, fuse, fuse_proposals, solve_contracted};
use crate::heuristics::segmentation::segment;
use crate::heuristics::start::contract_and_move;

/// Most rounds.
const ROUNDS: usize = 40;

/// Kernels with fewer edges, or with costs that are not integers, get only rounds that pay: the relaxation closes them quickly,
/// and without rounding up a packing must be exact.
const SMALL: usize = 3_000;

/// Rounds without a better solution or packing before the last one.
const PATIENCE: usize = 4;

/// Most halvings of the weights that are rerouted.
const HALVINGS: u32 = 4;

/// Segments count as poor if they are worse by this share of the objective.
const POOR: f64 = 0.02;

/// In a huge kernel, an order whose segments miss more than this share of the negative costs is no band, and not shortened.
const ROUGH: f64 = 0.15;

/// Fusion moves on the clusters where the gap is.
const PROPOSALS: usize = 4;

/// Most fusion moves where a large graph is no band, and how much four of them must gain, as a share of the payment.
const FUSIONS: usize = 24;
const WORTH: f64 = 0.01;

/// Shares of an edge's cost below this count as used up.
const SPARE: f64 = 1e-6;

/// Number of edges above which segments are the start, and contraction is left out, if no multicut can be better by more than
/// the share [`POOR`] of the negative costs.
pub(super) const HUGE: usize = 1_000_000;

/// Whether a kernel is huge, and a solution with this objective near its negative costs.
pub(super) fn is_huge_band(graph: &SignedGraph, objective: f64) -> bool {
    graph.edges().count() > HUGE && objective <= graph.negative_sum() * (1.0 - POOR)
}

/// The first solution of a huge kernel: by segments if they are good, otherwise by contraction and moves.
pub(super) fn start(graph: &SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let mut labels = segments(graph, budget);
    if is_huge_band(graph, graph.objective(&labels)) {
        kernighan_lin_with_joins(graph, &mut labels, budget);
        return labels;
    }
    contract_and_move(graph, budget)
}

/// Improves solution and bound of a kernel in turn. The best segmentation of an order along the band is fused with the
/// solution. Then the solution guides the packing ([`reroute`]), and the capacity that the packing leaves guides the solution:
/// were the packing tight, an optimum would cut no attractive edge with capacity left.
pub(crate) fn tighten(graph: &SignedGraph, state: &mut State, budget: &mut Budget) {
    if state.is_closed() || budget.is_over() {
        return;
    }
    let kernel = Kernel::new(graph);
    let band = offer_segments(graph, state, budget);
    let polish = if band { Polish::KernighanLin } else { Polish::of(graph) };
    if polish == Polish::Moves {
        let worth = WORTH * (state.objective - kernel.negative_sum());
        let mut labels = state.labels.clone();
        let moves = Fusions { first: 0, most: FUSIONS, worth, polish, seed: 0 };
        fuse_proposals(graph, &mut labels, &moves, budget);
        state.offer(graph, labels);
    }
    let mean = kernel.costs.iter().map(|cost| cost.abs()).sum::<f64>() / kernel.edge_count() as f64;
    let (mut idle, mut halvings) = (0, 0);
    for round in 0..ROUNDS {
        let (objective, bound) = (state.objective, state.packing().bound);
        let quantum = if kernel.integral { 1.0 } else { mean } / f64::from(1u32 << halvings);
        let effort = Effort { patience: 1 << idle, keep: round % 2 == 1, quantum };
        let packing = reroute(&kernel, state.packing(), &state.labels, &effort, budget);
        state.repack(&kernel, packing);
        if state.is_closed() || budget.is_over() {
            return;
        }
        let residual = &state.packing().residual;
        let left = |tail: u32, head: u32| {
            kernel.edge(tail, head).is_some_and(|edge| {
                let edge = edge as usize;
                kernel.costs[edge] > 0.0 && residual[edge] > SPARE * kernel.costs[edge]
            })
        };
        let labels = solve_contracted(graph, left, polish, budget);
        offer_both(graph, state, labels, polish, budget);
        let labels = focus(graph, &kernel, state, round, polish, budget);
        state.offer(graph, labels);
        let better = state.objective < objective || state.packing().bound > bound;
        idle = if better { 0 } else { idle + 1 };
        let patience = if kernel.edge_count() < SMALL || !kernel.integral { 0 } else { PATIENCE };
        if idle > patience {
            return;
        }
        if round % 2 == 1 || idle > 0 {
            halvings = (halvings + 1).min(HALVINGS);
        }
    }
}

/// Offers the best segmentation of an order along the band, and whether it is good: where the graph is no band, segments are too
/// poor to be worth polishing.
fn offer_segments(graph: &SignedGraph, state: &mut State, budget: &mut Budget) -> bool {
    // Segments are the start of huge bands.
    if is_huge_band(graph, state.objective) {
        return true;
    }
    let mut labels = segments(graph, budget);
    if graph.objective(&labels) > state.objective + POOR * state.objective.abs() {
        return false;
    }
    kernighan_lin_with_joins(graph, &mut labels, budget);
    offer_both(graph, state, labels, Polish::KernighanLin, budget);
    true
}

/// The best segmentation of an order along the band.
fn segments(graph: &SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let mut order = band_order(graph);
    let rough = segment(graph, &order, budget);
    if graph.edges().count() > HUGE && graph.objective(&rough) > graph.negative_sum() * (1.0 - ROUGH) {
        return rough;
    }
    shorten(graph, &mut order);
    segment(graph, &order, budget)
}

/// Offers a solution, and its fusion with the best one.
fn offer_both(graph: &SignedGraph, state: &mut State, labels: Vec<u32>, polish: Polish, budget: &mut Budget) {
    if budget.is_over() {
        state.offer(graph, labels);
        return;
    }
    let fused = fuse(graph, &labels, &state.labels, polish, budget);
    state.offer(graph, labels);
    state.offer(graph, fused);
}

/// Improves the clusters near paid edges with capacity left by fusion moves. By complementary slackness, only there the
/// solution or the packing can be better.
fn focus(
    graph: &SignedGraph,
    kernel: &Kernel,
    state: &State,
    round: usize,
    polish: Polish,
    budget: &mut Budget,
) -> Vec<u32> {
    let labels = &state.labels;
    let clusters = labels.iter().max().map_or(0, |&label| label as usize + 1);
    let mut chosen = vec![false; clusters];
    for (edge, &(tail, head)) in kernel.ends.iter().enumerate() {
        let (tail, head) = (labels[tail as usize], labels[head as usize]);
        let paid = (tail == head) == (kernel.costs[edge] < 0.0);
        if paid && state.packing().residual[edge] > SPARE * kernel.costs[edge].abs() {
            chosen[tail as usize] = true;
            chosen[head as usize] = true;
        }
    }
    let core = chosen.clone();
    for (edge, &(tail, head)) in kernel.ends.iter().enumerate() {
        let (tail, head) = (labels[tail as usize] as usize, labels[head as usize] as usize);
        if kernel.costs[edge] > 0.0 && (core[tail] || core[head]) {
            chosen[tail] = true;
            chosen[head] = true;
        }
    }
    let nodes: Vec<u32> = graph.nodes().filter(|&node| chosen[labels[node as usize] as usize]).collect();
    let mut place = vec![u32::MAX; graph.node_count()];
    for (at, &node) in nodes.iter().enumerate() {
        place[node as usize] = at as u32;
    }
    let inside = nodes.iter().enumerate().flat_map(|(at, &node)| {
        let place = &place;
        let arcs = graph
            .arcs(node)
            .iter()
            .filter(move |arc| arc.node > node && place[arc.node as usize] != u32::MAX);
        arcs.map(move |arc| (at as u32, place[arc.node as usize], arc.cost))
    });
    let part = SignedGraph::new(nodes.len(), inside);
    let mut inner: Vec<u32> = nodes.iter().map(|&node| labels[node as usize]).collect();
    // The first ones begin where those on the whole kernel ended at the latest.
    let first = FUSIONS + round * PROPOSALS;
    let moves = Fusions { first, most: PROPOSALS, worth: 0.0, polish, seed: round as u64 };
    fuse_proposals(&part, &mut inner, &moves, budget);
    let mut labels = labels.clone();
    for (&node, &label) in nodes.iter().zip(&inner) {
        labels[node as usize] = clusters as u32 + label;
    }
    labels
}

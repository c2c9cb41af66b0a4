//! Small parts of a kernel solved exactly where a packing leaves a gap.

use super::search::{Inside, State, solve_part};
use crate::bound::windows::{Ball, Index, Window, improve_in_windows};
use crate::budget::Budget;
use crate::certificate::proof::{Cutout, Proof};
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::heuristics::local_search::{Polish, solve_contracted};

/// Kernels with fewer edges are closed as a whole.
const SMALL: usize = 1_500;

/// Sizes of windows, in nodes, in which the packing is improved, and the share of the gap that this should close.
const PACKED: [usize; 2] = [200, 800];
const WORTH: f64 = 0.1;

/// Passes over all places: sizes of windows in nodes, tried in turn until one closes the gap of its place, and the work on one
/// window for each of its nodes. What closes cheaply comes first, because it leaves fewer places to the next pass.
const PASSES: [(&[usize], u64); 3] =
    [(&[300, 1_200], 20_000), (&[1_200, 2_400], 200_000), (&[2_400, 4_800], 2_000_000)];

/// Gap of a window, in mean costs, that counts as closed.
const CLOSED: f64 = 1e-4;

/// Most solutions of windows that are tried on the whole.
const TRIES: usize = 50;

/// Most better solutions that start the search again.
const RESTARTS: usize = 20;

/// Closes the gap of a kernel, or narrows it, in windows around the places where the packing does not prove the solution optimal:
/// first by better packings ([`improve_in_windows`]), then by exact solutions.
///
/// A window is solved with the capacity that conflicts outside leave (see [`Index`]). So its bound adds to theirs, and a window
/// is closed if no multicut of it is better than the solution there. That is much easier than the whole: a few thousand edges,
/// most of which reductions remove.
pub(crate) fn close_in_windows(graph: &SignedGraph, state: &mut State, budget: &mut Budget) {
    if state.is_closed() || budget.is_over() || !state.has_packing() {
        return;
    }
    let kernel = Kernel::new(graph);
    // Gaps of many windows add up to less than one, which is enough only if costs are integers.
    if kernel.edge_count() < SMALL || !kernel.integral {
        return;
    }
    for _ in 0..RESTARTS {
        pack_windows(&kernel, state, budget);
        if state.is_closed() || budget.is_over() || !solve_windows(graph, &kernel, state, budget) {
            return;
        }
    }
}

/// Improves the packing in windows of increasing size.
fn pack_windows(kernel: &Kernel, state: &mut State, budget: &mut Budget) {
    let before = state.packing().bound;
    let mut packing = state.packing().clone();
    for size in PACKED {
        let closed = kernel.rounded(packing.bound) >= state.objective - state.tolerance;
        if closed || 2 * size > kernel.node_count() || budget.is_over() {
            break;
        }
        packing = improve_in_windows(kernel, &packing, &state.labels, size, budget);
    }
    // Weights of linear programs are no longer simple fractions, which makes exact solutions harder: not for little.
    if packing.bound - before >= WORTH * (state.objective - before) {
        state.repack(kernel, packing);
    }
}

/// Solves windows at all places with a gap; true if the solution became better.
fn solve_windows(graph: &SignedGraph, kernel: &Kernel, state: &mut State, budget: &mut Budget) -> bool {
    let labels = state.labels.clone();
    let mut index = Index::new(kernel, state.packing(), &labels);
    let mut ball = Ball::new(kernel.node_count());
    let mut windows = Vec::new();
    let mut tries = TRIES;
    for (sizes, effort) in PASSES {
        let pass = Pass { sizes, effort, record: state.proof.is_some() };
        for spot in 0..kernel.edge_count() as u32 {
            if budget.is_over() || kernel.rounded(index.bound()) >= state.objective - state.tolerance {
                break;
            }
            if !index.is_spot(spot) {
                continue;
            }
            match close_place(&index, &mut ball, spot, &pass, budget) {
                Place::Closed(window, inside) => {
                    if let Some(proof) = inside.proof {
                        let (nodes, edges) = (window.nodes.clone(), window.graph.edges().collect());
                        windows.push(Cutout { nodes, edges, proof });
                    }
                    index.give(window, inside.bound);
                }
                Place::Better(window, inside) if tries > 0 => {
                    tries -= 1;
                    let before = state.objective;
                    state.offer(graph, applied(graph, &labels, &window, &inside.labels, budget));
                    if state.objective < before {
                        return true;
                    }
                }
                Place::Open | Place::Better(..) => {}
            }
        }
    }
    let bound = kernel.rounded(index.bound());
    let conflicts = index.packing().conflicts;
    state.raise(bound, || Some(Proof::Windows { conflicts, windows }));
    false
}

/// What a place with a gap came to.
enum Place {
    Open,
    /// No multicut of the window is better than the solution there.
    Closed(Window, Inside),
    /// A multicut of the window is better than the solution there, with the capacities that the window has.
    Better(Window, Inside),
}

/// The windows of a pass, and how much work one may take for each node.
struct Pass {
    sizes: &'static [usize],
    effort: u64,
    record: bool,
}

/// Solves windows around an edge, until one is closed. A window that is too small lacks capacity that its solution needs, so
/// only the last one counts as better.
fn close_place(index: &Index, ball: &mut Ball, spot: u32, pass: &Pass, budget: &mut Budget) -> Place {
    let mut better = Place::Open;
    for &size in pass.sizes {
        if 2 * size > index.kernel.node_count() || budget.is_over() {
            break;
        }
        ball.grow(index.kernel, spot, size, budget);
        let window = index.window(ball);
        ball.clear();
        let cutoff = window.objective - CLOSED * index.mean;
        if window.bound >= cutoff {
            break;
        }
        let mut part = budget.part(pass.effort * size as u64);
        let inside = solve_part(window.graph.clone(), cutoff, pass.record, &mut part);
        budget.charge(&part);
        if inside.bound >= cutoff {
            return Place::Closed(window, inside);
        }
        better = if window.graph.objective(&inside.labels) < cutoff {
            Place::Better(window, inside)
        } else {
            Place::Open
        };
    }
    better
}

/// The solution with a window's clusters, joined with each other and with those around where that pays.
fn applied(
    graph: &SignedGraph,
    labels: &[u32],
    window: &Window,
    inner: &[u32],
    budget: &mut Budget,
) -> Vec<u32> {
    let mut changed = labels.to_vec();
    let fresh = labels.iter().max().map_or(0, |&label| label + 1);
    for (&node, &label) in window.nodes.iter().zip(inner) {
        changed[node as usize] = fresh + label;
    }
    let same = |tail: u32, head: u32| changed[tail as usize] == changed[head as usize];
    solve_contracted(graph, same, Polish::KernighanLin, budget)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::certificate::proof::{Certificate, Reduced};
    use crate::certificate::verify::verify;
    use crate::generate::{Family, generate};
    use crate::heuristics::start::contract_and_move;
    use crate::options::Solver;
    use crate::reduce::decomposition::Trace;
    use crate::solve::search::survey;

    #[test]
    fn windows_raise_the_bound_and_the_verifier_confirms_it() {
        for seed in 1..4 {
            let instance = generate(Family::Follow, 1500, 0.1, seed).unwrap();
            let edges = instance.edges().iter().map(|edge| (edge.tail, edge.head, edge.cost));
            let graph = SignedGraph::new(instance.node_count(), edges);
            let budget = &mut Budget::new(None, Some(200_000_000));
            let labels = contract_and_move(&graph, budget);
            // A greedy packing leaves gaps in many places.
            let mut state = survey(&graph, labels, Solver::Exact, true, budget);
            let before = state.bound;
            let kernel = Kernel::new(&graph);
            while solve_windows(&graph, &kernel, &mut state, budget) {}
            assert!(state.bound > before, "{before} {}", state.bound);
            let proof = state.proof.clone().unwrap();
            let Proof::Windows { windows, .. } = &proof else { panic!("{proof:?}") };
            assert!(!windows.is_empty());
            let nodes: Vec<u32> = graph.nodes().collect();
            let trace = Trace {
                parent: None,
                names: nodes.clone(),
                steps: Vec::new(),
                kernel: Some(0),
                packed: None,
            };
            let reduced = Reduced { trace: vec![trace], kernels: vec![proof] };
            let certificate =
                Certificate { labels: state.labels.clone(), components: vec![(nodes, reduced)] };
            let mut text = Vec::new();
            certificate.write(&mut text).unwrap();
            assert_eq!(verify(&instance, text.as_slice()).unwrap().lower_bound, state.bound);
        }
    }
}

//! Branch and cut on kernels.

use super::bands::is_huge_band;
use super::cut_tree;
use super::fixing::fix;
use super::inheritance::Inheritance;
use super::rounding::round;
use crate::bound::conflict::Conflict;
use crate::bound::packing::Packing;
use crate::bound::relaxation::{Relaxation, solve_relaxation};
use crate::budget::Budget;
use crate::certificate::proof::{Proof, Reduced};
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::sum::Sum;
use crate::heuristics::kernighan_lin::kernighan_lin_with_joins;
use crate::heuristics::local_search::{Fusions, NOISY, Polish, fuse_proposals, solve_contracted};
use crate::heuristics::start::contract;
use crate::options::Solver;
use crate::reduce::decomposition::decompose;

/// What is known about the optimum of a kernel.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub(crate) labels: Vec<u32>,
    /// Objective of `labels`: an upper bound.
    pub(crate) objective: f64,
    /// Lower bound on the optimum.
    pub(crate) bound: f64,
    /// Gap up to which the kernel counts as closed.
    pub(super) tolerance: f64,
    packing: Packing,
    /// Proof of the bound, if a certificate is wanted.
    pub(crate) proof: Option<Proof>,
}

/// Differences up to this share of the absolute costs count as zero where costs are not integers.
const TOLERANCE: f64 = 1e-10;

/// The same inside the tree, where differences must be smaller so that their sum stays below [`TOLERANCE`].
const INNER_TOLERANCE: f64 = 1e-12;

/// A relaxation that stalls, or has not begun, gives way to one with fixed edges if fixing saves at least one node in this many.
const FEW: usize = 50;

/// Largest kernel, in edges, that one linear program with an inverse of its basis suits.
const SMALL: usize = 1_500;

/// Kernels of up to this many edges go to it at once; the interior point method closes many larger ones faster.
const TINY: usize = 500;

fn magnitude(graph: &SignedGraph) -> f64 {
    graph.edges().map(|(_, _, cost)| cost.abs()).sum()
}

impl State {
    pub(crate) fn is_closed(&self) -> bool {
        self.bound >= self.objective - self.tolerance
    }

    /// A solution with the trivial lower bound.
    fn unknown(graph: &SignedGraph, labels: Vec<u32>, record: bool) -> Self {
        let (objective, packing) = (graph.objective(&labels), Packing::default());
        let bound = graph.negative_sum();
        let tolerance = TOLERANCE * magnitude(graph);
        State {
            labels,
            objective,
            bound,
            tolerance,
            packing,
            proof: record.then(|| Proof::Packing(Vec::new())),
        }
    }

    /// Replaces the bound by a better one.
    pub(super) fn raise(&mut self, bound: f64, proof: impl FnOnce() -> Option<Proof>) {
        if bound > self.bound {
            self.bound = bound;
            if self.proof.is_some() {
                self.proof = proof();
            }
        }
    }

    /// The packing of the kernel itself, which the bound may exceed.
    pub(super) fn packing(&self) -> &Packing {
        &self.packing
    }

    /// Whether there is a packing; none was sought if the budget was over.
    pub(super) fn has_packing(&self) -> bool {
        !self.packing.residual.is_empty()
    }

    /// Replaces the packing.
    pub(super) fn repack(&mut self, kernel: &Kernel, packing: Packing) {
        self.raise(kernel.rounded(packing.bound), || Some(Proof::Packing(packing.conflicts.clone())));
        self.packing = packing;
    }

    pub(super) fn offer(&mut self, graph: &SignedGraph, labels: Vec<u32>) {
        let objective = graph.objective(&labels);
        if objective < self.objective {
            self.objective = objective;
            self.labels = labels;
        }
    }
}

/// Work on the first packing: a constant, plus some for each edge. Long cycles in large kernels cost more than they gain.
fn packing_effort(solver: Solver, edges: usize) -> u64 {
    let (each, besides) = match solver {
        Solver::Exact => (200, 20_000_000),
        Solver::Klj => (20, 100_000),
        Solver::Gaec => (5, 10_000),
    };
    besides + each * edges as u64
}

/// The state of a kernel with a given solution: its objective and the packing bound. If costs are not integers, the capacity
/// that the packing leaves is so informative about an optimum that Kernighan-Lin uses it at once.
pub(crate) fn survey(
    graph: &SignedGraph,
    labels: Vec<u32>,
    solver: Solver,
    record: bool,
    budget: &mut Budget,
) -> State {
    if budget.is_over() {
        return State::unknown(graph, labels, record);
    }
    let kernel = Kernel::new(graph);
    let mut packing = Packing::new(&kernel);
    let objective = graph.objective(&labels);
    // In a huge band, rerouting gains more for the same work.
    let effort = if is_huge_band(graph, objective) { Solver::Klj } else { solver };
    packing.extend(&kernel, packing_effort(effort, kernel.edge_count()), budget);
    let tolerance = TOLERANCE * magnitude(graph);
    let proof = record.then(|| Proof::Packing(packing.conflicts.clone()));
    let mut state =
        State { labels, objective, bound: kernel.rounded(packing.bound), tolerance, packing, proof };
    if solver == Solver::Klj && !kernel.integral && !state.is_closed() {
        improve(graph, &mut state, 0, 0, budget);
    }
    state
}

/// Improves the solution of a kernel by local search.
pub(crate) fn improve(graph: &SignedGraph, state: &mut State, rounds: usize, seed: u64, budget: &mut Budget) {
    if budget.is_over() {
        return;
    }
    // If the packing were tight, an optimum would cut no attractive edge with remaining capacity.
    let kernel = Kernel::new(graph);
    let left = |tail: u32, head: u32| {
        let edge = kernel.edge(tail, head).map_or(0, |edge| edge as usize);
        kernel.costs[edge] > 0.0 && state.packing.residual[edge] > 1e-6 * kernel.costs[edge]
    };
    let labels = solve_contracted(graph, left, Polish::KernighanLin, budget);
    state.offer(graph, labels);
    if state.is_closed() {
        return;
    }
    let mut labels = state.labels.clone();
    let polish = Polish::of(graph);
    // The plain contractions are known.
    let moves = Fusions { first: NOISY, most: rounds, worth: 0.0, polish, seed };
    fuse_proposals(graph, &mut labels, &moves, budget);
    state.offer(graph, labels);
}

/// Closes the gap of a kernel: relaxation, rounding, fixing, branching.
pub(crate) fn close(graph: &SignedGraph, state: &mut State, budget: &mut Budget) {
    let magnitude = magnitude(graph);
    let tree = Tree { big: 1.0 + magnitude.ceil(), tolerance: INNER_TOLERANCE * magnitude };
    tree.close(graph, state, Vec::new(), f64::INFINITY, budget);
}

/// Solves a graph as far as needed to decide whether its optimum is below `cutoff`.
pub(super) fn solve_part(graph: SignedGraph, cutoff: f64, record: bool, budget: &mut Budget) -> Inside {
    let magnitude = magnitude(&graph);
    let tree = Tree { big: 1.0 + magnitude.ceil(), tolerance: INNER_TOLERANCE * magnitude };
    tree.solve_within(graph, &[], cutoff, record, budget)
}

/// One kernel's branch-and-cut tree.
struct Tree {
    /// More than all costs of the kernel together: an edge with this cost is always joined, and one with minus twice this
    /// cost always cut. The whole tree uses one value, because it would grow with the depth otherwise.
    big: f64,
    /// Gap that counts as closed within the tree. It is absolute, because big costs would make a relative one too large.
    tolerance: f64,
}

impl Tree {
    /// Closes the gap of a node of the tree, or raises its bound to `cutoff`, which already allows for rounding. Its program
    /// starts from `known`, conflicts of the kernel.
    fn close(
        &self,
        graph: &SignedGraph,
        state: &mut State,
        known: Vec<Conflict>,
        cutoff: f64,
        budget: &mut Budget,
    ) {
        let goal = |state: &State| cutoff.min(state.objective - self.tolerance);
        if state.bound >= goal(state) || budget.is_over() {
            return;
        }
        let kernel = Kernel::new(graph);
        if kernel.edge_count() <= TINY {
            return self.grow(graph, &kernel, state, cutoff, budget);
        }
        let packing = std::mem::take(&mut state.packing);
        let target = goal(state);
        let small = kernel.edge_count() <= SMALL;
        let pays = |packing: &Packing| {
            small || fix(&kernel, packing, target).edges.len() * FEW >= graph.node_count()
        };
        let at_once = !small && pays(&packing);
        let relaxation = if at_once {
            Relaxation::of(&kernel, packing, known)
        } else {
            solve_relaxation(&kernel, packing, known, target, pays, budget)
        };
        let packing = relaxation.packing.clone();
        let bound = kernel.rounded(packing.bound);
        state.raise(bound, || Some(Proof::Packing(packing.conflicts.clone())));
        if !at_once {
            round(graph, &kernel, &relaxation, state, budget);
        }
        if small {
            state.packing = packing;
            return self.grow(graph, &kernel, state, cutoff, budget);
        }
        if state.bound < goal(state) && !budget.is_over() {
            let fixed = fix(&kernel, &packing, goal(state));
            if fixed.edges.is_empty() {
                self.branch(graph, &kernel, &relaxation, state, cutoff, budget);
            } else {
                // Solutions that the fixed graph excludes are no better than the best known one.
                let Inside { labels, bound, proof } = self.solve_within(
                    fixed.rewarded(graph, self.big),
                    &relaxation.conflicts,
                    goal(state),
                    state.proof.is_some(),
                    budget,
                );
                state.offer(graph, labels);
                state.raise(bound.min(fixed.left_out), || {
                    let (conflicts, edges) = (packing.conflicts.clone(), fixed.edges);
                    Some(Proof::Fixed { conflicts, edges, reward: self.big, rest: proof? })
                });
            }
        }
        state.packing = packing;
    }

    /// Closes the gap of a small kernel with one linear program throughout.
    fn grow(
        &self,
        graph: &SignedGraph,
        kernel: &Kernel,
        state: &mut State,
        cutoff: f64,
        budget: &mut Budget,
    ) {
        if state.bound >= cutoff.min(state.objective - self.tolerance) || budget.is_over() {
            return;
        }
        let task = cut_tree::Task {
            graph,
            kernel,
            start: &state.packing.conflicts,
            cutoff,
            tolerance: self.tolerance,
            record: state.proof.is_some(),
        };
        let found = cut_tree::search(&task, state.labels.clone(), state.objective, budget);
        if found.objective < state.objective {
            (state.objective, state.labels) = (found.objective, found.labels);
        }
        state.raise(found.bound, || found.proof.map(Proof::Tree));
    }

    /// Decomposes a graph, and solves its kernels as far as needed to decide whether its optimum is below `cutoff`.
    /// The kernels inherit `known`, conflicts of the graph.
    fn solve_within(
        &self,
        graph: SignedGraph,
        known: &[Conflict],
        cutoff: f64,
        record: bool,
        budget: &mut Budget,
    ) -> Inside {
        let decomposition = decompose(graph, record, budget);
        let kernels = &decomposition.kernels;
        let inheritance = Inheritance::new(&decomposition, known);
        let mut states: Vec<State> = kernels
            .iter()
            .map(|piece| {
                let mut labels = contract(&piece.graph, budget);
                kernighan_lin_with_joins(&piece.graph, &mut labels, budget);
                survey(&piece.graph, labels, Solver::Exact, record, budget)
            })
            .collect();
        let total = |states: &[State]| {
            let mut sum = Sum::default();
            sum.add(decomposition.constant);
            for state in states {
                sum.add(state.bound);
            }
            sum.value()
        };
        let mut order: Vec<usize> = (0..kernels.len()).collect();
        order.sort_by_key(|&index| kernels[index].graph.node_count());
        for index in order {
            let others = total(&states);
            if others >= cutoff {
                break;
            }
            let slack = cutoff - (others - states[index].bound);
            let graph = &kernels[index].graph;
            let known = inheritance.of(index, graph);
            self.close(graph, &mut states[index], known, slack, budget);
        }
        let labels = decomposition.assemble(states.iter().map(|state| state.labels.as_slice()));
        let bound = total(&states);
        let kernels = states.into_iter().map_while(|state| state.proof).collect();
        let proof = decomposition.trace.map(|trace| Reduced { trace, kernels });
        Inside { labels, bound, proof }
    }

    /// Branches on the attractive edge whose value is closest to one half: its ends are joined, or apart.
    fn branch(
        &self,
        graph: &SignedGraph,
        kernel: &Kernel,
        relaxation: &Relaxation,
        state: &mut State,
        cutoff: f64,
        budget: &mut Budget,
    ) {
        let undecided = |edge: usize| (relaxation.paid[edge] - 0.5).abs();
        let Some(edge) =
            (0..kernel.edge_count()).filter(|&edge| kernel.costs[edge] > 0.0).min_by(|&a, &b| {
                undecided(a).total_cmp(&undecided(b)).then(kernel.costs[b].total_cmp(&kernel.costs[a]))
            })
        else {
            return;
        };
        let (tail, head) = kernel.ends[edge];
        let record = state.proof.is_some();
        let mut bound = f64::INFINITY;
        let mut proofs = [None, None];
        for apart in [relaxation.paid[edge] > 0.5, relaxation.paid[edge] <= 0.5] {
            let mut child = graph.clone();
            child.add_cost(tail, head, if apart { -2.0 * self.big } else { self.big });
            // An edge that is always cut adds its big negative cost; the constant compensates for it.
            let constant = if apart { 2.0 * self.big } else { 0.0 };
            let goal = cutoff.min(state.objective - self.tolerance) - constant;
            let inside = self.solve_within(child, &relaxation.conflicts, goal, record, budget);
            state.offer(graph, inside.labels);
            bound = bound.min(inside.bound + constant);
            proofs[usize::from(apart)] = inside.proof;
        }
        let [joined, apart] = proofs;
        state.raise(bound, || {
            Some(Proof::Branch { edge: (tail, head), reward: self.big, joined: joined?, apart: apart? })
        });
    }
}

/// Labels, bound and proof of a graph.
pub(super) struct Inside {
    pub(super) labels: Vec<u32>,
    pub(super) bound: f64,
    pub(super) proof: Option<Reduced>,
}

//! Solves the whole graph, one conflicted component after the other.
//!
//! Each component is reduced to kernels. [`search`] closes a kernel by branch and cut: a packing, the cycle relaxation with
//! odd wheels, nodes joined by the capacity left between them ([`fixing`]), branching; [`cut_tree`] closes small kernels, with one linear
//! program throughout. Before that, small kernels are annealed and dense ones bounded by spread conflicts ([`preparation`]), and solution
//! and packing of long ones improved in turn ([`bands`]), and the places where they differ solved apart ([`windows`]). Depends on all the
//! theory of this crate: [`reduce`](crate::reduce),
//! [`heuristics`](crate::heuristics), [`bound`](crate::bound), [`certificate`](crate::certificate).

mod bands;
mod cut_tree;
mod fixing;
mod inheritance;
mod preparation;
mod rounding;
mod search;
mod windows;

use std::time::Instant;

use crate::budget::Budget;
use crate::certificate::proof::{Certificate, Reduced};
use crate::graph::canonical::canonical_order;
use crate::graph::instance::Graph;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::sum::Sum;
use crate::graph::union_find::UnionFind;
use crate::heuristics::start::{contract, contract_and_move};
use crate::options::{Options, Solver};
use crate::reduce::decomposition::{Decomposition, decompose};
use bands::HUGE;
use preparation::{bound_by_spreading, prepare};
use search::{State, close, improve, survey};

/// A multicut and its lower bound.
#[derive(Debug, Clone)]
pub struct Solution {
    /// Cluster of each node, numbered by first appearance. An edge is cut if and only if its ends have different labels.
    /// Every cluster is connected by edges that are not cut.
    pub labels: Vec<u32>,
    /// Cost of the cut edges.
    pub objective: f64,
    /// No multicut costs less than this.
    pub lower_bound: f64,
    /// Whether the objective is proved to be minimal: exactly for integer costs, otherwise up to 10^-10 of the sum of
    /// absolute costs.
    pub optimal: bool,
    /// Nodes of the kernels that remain after reductions.
    pub kernel_nodes: usize,
    /// Edges of those kernels.
    pub kernel_edges: usize,
    /// Nodes and edges of the largest kernel.
    pub largest_kernel: (usize, usize),
    /// Proof of the lower bound, if [`Options::certificate`] asked for one.
    pub certificate: Option<Certificate>,
    /// Work done, in the units of [`Options::work_limit`].
    pub work: u64,
    /// Wall time in seconds.
    pub seconds: f64,
}

impl Solution {
    /// Objective minus lower bound; 0 if optimal.
    pub fn gap(&self) -> f64 {
        if self.optimal { 0.0 } else { self.objective - self.lower_bound }
    }
}

/// One conflicted component: its nodes in canonical order, its decomposition, and the states of its kernels.
struct Component {
    nodes: Vec<u32>,
    decomposition: Decomposition,
    states: Vec<State>,
}

/// Finds a minimum-cost multicut of `graph`, or the best one within the limits, and a lower bound.
///
/// Repulsive edges between different components of the attractive edges are cut. Components without repulsive edges inside
/// are joined. The rest is reduced to kernels (see the crate's documentation), and only these are searched. Near-linear where
/// kernels are small.
///
/// Renumbering the nodes never changes the objective and bound of a completed proof (except for rounding of costs that are
/// not integers), nor the partition where the optimum is unique. If several partitions are optimal, or no proof completes,
/// ties are broken by a node order computed from the graph itself. In each conflicted component, this order is refined until
/// it distinguishes all nodes that are not images of each other (as far as colour refinement can see), or until it has
/// visited 60 million nodes and edges. That always suffices up to 3,000 nodes and edges, and for most irregular graphs up to
/// a million. In a larger component, nodes that look the same up to four edges away are ordered by number, and renumbering
/// may then give another partition. The order of edges and the number of threads change nothing.
pub fn solve(graph: &Graph, options: &Options) -> Solution {
    let start = Instant::now();
    let mut budget = Budget::new(options.time_limit, options.work_limit);
    let mut joined = attractive_components(graph);
    let mut bound = Sum::default();
    let mut components = Vec::new();
    for (nodes, local) in conflicted_components(graph, &mut joined, &mut bound) {
        let (mut nodes, mut local) = (nodes, local);
        if budget.spend((local.node_count() + local.edges().count()) as u64) {
            let order = canonical_order(&local);
            nodes = order.iter().map(|&node| nodes[node as usize]).collect();
            local = local.permuted(&order);
        }
        let decomposition = decompose(local, options.certificate, &mut budget);
        components.push(Component { nodes, decomposition, states: Vec::new() });
    }
    survey_all(&mut components, options, &mut budget);
    if options.solver == Solver::Exact {
        close_all(&mut components, options.seed, &mut budget);
    }
    let kernels = || components.iter().flat_map(|component| &component.decomposition.kernels);
    let kernel_nodes = kernels().map(|piece| piece.graph.node_count()).sum();
    let sizes = || kernels().map(|piece| (piece.graph.node_count(), piece.graph.edges().count()));
    let kernel_edges = sizes().map(|size| size.1).sum();
    let largest_kernel = sizes().max_by_key(|size| (size.1, size.0)).unwrap_or((0, 0));
    let mut closed = true;
    for component in &components {
        bound.add(component.decomposition.constant);
        for state in &component.states {
            closed &= state.is_closed();
            bound.add(state.bound);
        }
        let labels = component.states.iter().map(|state| state.labels.as_slice());
        let labels = component.decomposition.assemble(labels);
        join_classes(&component.nodes, &labels, &mut joined);
    }
    let labels = joined.labels();
    let objective = graph.objective(&labels).unwrap_or(f64::INFINITY);
    let certificate = options.certificate.then(|| certify(&labels, components));
    let lower_bound = bound.value();
    Solution {
        labels,
        objective,
        // A proof up to rounding is a proof: report the objective instead of a dual value that differs in the last digits.
        lower_bound: if closed { objective } else { lower_bound.min(objective) },
        optimal: closed,
        kernel_nodes,
        kernel_edges,
        largest_kernel,
        certificate,
        work: budget.spent(),
        seconds: start.elapsed().as_secs_f64(),
    }
}

fn certify(labels: &[u32], components: Vec<Component>) -> Certificate {
    let components = components.into_iter().filter_map(|component| {
        let trace = component.decomposition.trace?;
        let kernels = component.states.into_iter().map_while(|state| state.proof).collect();
        Some((component.nodes, Reduced { trace, kernels }))
    });
    Certificate { labels: labels.to_vec(), components: components.collect() }
}

/// Heuristic solutions and packing bounds. First finds a solution everywhere, then better ones, then bounds, so that every
/// kernel has a sensible solution when a limit is reached.
fn survey_all(components: &mut [Component], options: &Options, budget: &mut Budget) {
    let mut labels = Vec::new();
    for component in components.iter() {
        for piece in &component.decomposition.kernels {
            labels.push(match options.solver {
                Solver::Exact if piece.graph.edges().count() > HUGE => bands::start(&piece.graph, budget),
                Solver::Gaec => contract(&piece.graph, budget),
                Solver::Klj | Solver::Exact => contract_and_move(&piece.graph, budget),
            });
        }
    }
    let mut labels = labels.into_iter();
    for component in components {
        let pieces = component.decomposition.kernels.iter().zip(&mut labels);
        component.states = pieces
            .map(|(piece, labels)| survey(&piece.graph, labels, options.solver, options.certificate, budget))
            .collect();
    }
}

/// Fusion moves before the exact search, because a better solution prunes more.
const ROUNDS: usize = 8;

/// Closes kernels from small to large, so that few remain open when a limit is reached.
fn close_all(components: &mut [Component], seed: u64, budget: &mut Budget) {
    let mut open: Vec<(usize, usize, usize)> = Vec::new();
    for (index, component) in components.iter().enumerate() {
        for (place, state) in component.states.iter().enumerate() {
            if !state.is_closed() {
                open.push((component.decomposition.kernels[place].graph.node_count(), index, place));
            }
        }
    }
    open.sort_unstable();
    for (_, index, place) in open {
        if budget.is_over() {
            break;
        }
        let component = &mut components[index];
        let piece = &component.decomposition.kernels[place];
        prepare(&piece.graph, &mut component.states[place], seed, budget);
        bound_by_spreading(&piece.graph, &mut component.states[place], budget);
        bands::tighten(&piece.graph, &mut component.states[place], budget);
        improve(&piece.graph, &mut component.states[place], ROUNDS, seed, budget);
        windows::close_in_windows(&piece.graph, &mut component.states[place], budget);
        close(&piece.graph, &mut component.states[place], budget);
    }
}

fn attractive_components(graph: &Graph) -> UnionFind {
    let mut sets = UnionFind::new(graph.node_count());
    for edge in graph.edges() {
        if edge.cost > 0.0 {
            sets.union(edge.tail, edge.head);
        }
    }
    sets
}

/// The components of the attractive edges that have repulsive edges inside, as separate graphs. Their nodes become single
/// sets in `joined`. The cost of edges between components is added to `bound`.
fn conflicted_components(
    graph: &Graph,
    joined: &mut UnionFind,
    bound: &mut Sum,
) -> Vec<(Vec<u32>, SignedGraph)> {
    const NONE: u32 = u32::MAX;
    let node_count = graph.node_count();
    let mut component = vec![NONE; node_count];
    let mut count = 0u32;
    for edge in graph.edges() {
        let root = joined.find(edge.tail);
        if root != joined.find(edge.head) {
            bound.add(edge.cost);
        } else if edge.cost < 0.0 && component[root as usize] == NONE {
            component[root as usize] = count;
            count += 1;
        }
    }
    let mut nodes: Vec<Vec<u32>> = vec![Vec::new(); count as usize];
    let mut place = vec![NONE; node_count];
    for node in 0..node_count as u32 {
        let index = component[joined.find(node) as usize];
        if index != NONE {
            component[node as usize] = index;
            place[node as usize] = nodes[index as usize].len() as u32;
            nodes[index as usize].push(node);
        }
    }
    let mut edges: Vec<Vec<(u32, u32, f64)>> = vec![Vec::new(); count as usize];
    for edge in graph.edges() {
        let (tail, head) = (edge.tail as usize, edge.head as usize);
        if component[tail] != NONE && component[tail] == component[head] {
            edges[component[tail] as usize].push((place[tail], place[head], edge.cost));
        }
    }
    for members in &nodes {
        joined.dissolve(members);
    }
    nodes
        .into_iter()
        .zip(edges)
        .map(|(nodes, edges)| {
            let graph = SignedGraph::new(nodes.len(), edges.iter().copied());
            (nodes, graph)
        })
        .collect()
}

fn join_classes(nodes: &[u32], labels: &[u32], joined: &mut UnionFind) {
    let mut first = vec![u32::MAX; nodes.len()];
    for (&node, &label) in nodes.iter().zip(labels) {
        let first = &mut first[label as usize];
        if *first == u32::MAX {
            *first = node;
        } else {
            joined.union(*first, node);
        }
    }
}

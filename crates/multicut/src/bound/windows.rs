//! Packings improved window by window, each by its own linear program.

use super::conflict::{Conflict, Parts, Wheel};
use super::packing::{Packed, Packing};
use super::relaxation::solve_relaxation;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;

/// Capacities below this share of an edge's cost count as used up.
const SPARE: f64 = 1e-7;

/// Gaps of a window below this share of the mean cost count as closed.
const CLOSED: f64 = 1e-5;

/// Work on the linear program of a window for each of its nodes.
const EFFORT: u64 = 50_000;

/// A packing with the conflicts over each edge.
pub(crate) struct Index<'a> {
    pub(crate) kernel: &'a Kernel,
    labels: &'a [u32],
    packed: Vec<Option<Packed>>,
    over: Vec<Vec<u32>>,
    residual: Vec<f64>,
    bound: f64,
    pub(crate) mean: f64,
}

/// A part of a graph with the capacities that the conflicts inside use or leave.
pub(crate) struct Window {
    /// Its nodes in the graph.
    pub(crate) nodes: Vec<u32>,
    /// Its edges with their capacities as costs; nodes are positions in `nodes`.
    pub(crate) graph: SignedGraph,
    /// Objective of the labels, and bound by the conflicts inside.
    pub(crate) objective: f64,
    pub(crate) bound: f64,
    edges: Vec<u32>,
    capacities: Vec<f64>,
    released: Vec<(u32, Packed)>,
}

/// Improves a packing in windows of up to `size` nodes around the places where it does not prove `labels` optimal.
///
/// Any multicut costs `sum of negative costs + sum_q w_q p(q) + sum_e r_e p_e` for a packing with weights `w_q` and residual
/// `r_e` (Lagrangian decomposition). So the conflicts that lie in a window may be replaced by any that pack what they used
/// and the residual there; the linear program of that smaller graph finds the best ones (block coordinate ascent).
pub(crate) fn improve_in_windows(
    kernel: &Kernel,
    start: &Packing,
    labels: &[u32],
    size: usize,
    budget: &mut Budget,
) -> Packing {
    let mut index = Index::new(kernel, start, labels);
    let mut ball = Ball::new(kernel.node_count());
    let mut done = vec![false; kernel.edge_count()];
    let spots: Vec<u32> = (0..kernel.edge_count() as u32).filter(|&edge| index.is_spot(edge)).collect();
    for spot in spots {
        if done[spot as usize] || !index.is_spot(spot) {
            continue;
        }
        if budget.is_over() {
            break;
        }
        let inner = ball.grow(kernel, spot, size, budget);
        let window = index.window(&ball);
        index.improve(window, budget);
        for &node in &ball.nodes[..inner] {
            for &(_, edge) in kernel.arcs(node) {
                done[edge as usize] |= ball.inner(kernel.ends[edge as usize], inner);
            }
        }
        ball.clear();
    }
    let packing = index.packing();
    if packing.bound > start.bound { packing } else { start.clone() }
}

pub(crate) struct Ball {
    nodes: Vec<u32>,
    place: Vec<u32>,
}

impl Ball {
    pub(crate) fn new(nodes: usize) -> Self {
        Self { nodes: Vec::new(), place: vec![u32::MAX; nodes] }
    }

    fn visit(&mut self, node: u32) {
        if self.place[node as usize] == u32::MAX {
            self.place[node as usize] = self.nodes.len() as u32;
            self.nodes.push(node);
        }
    }

    /// The nodes around an edge, breadth first over attractive edges; returns how many are well inside.
    pub(crate) fn grow(&mut self, kernel: &Kernel, edge: u32, size: usize, budget: &mut Budget) -> usize {
        let (tail, head) = kernel.ends[edge as usize];
        self.visit(tail);
        self.visit(head);
        let mut next = 0;
        while next < self.nodes.len() && self.nodes.len() < size {
            let node = self.nodes[next];
            next += 1;
            budget.spend(kernel.arcs(node).len() as u64);
            for &(other, edge) in kernel.arcs(node) {
                if kernel.costs[edge as usize] > 0.0 && self.nodes.len() < size {
                    self.visit(other);
                }
            }
        }
        self.nodes.len() / 2
    }

    fn inner(&self, (tail, head): (u32, u32), inner: usize) -> bool {
        (self.place[tail as usize] as usize) < inner && (self.place[head as usize] as usize) < inner
    }

    pub(crate) fn clear(&mut self) {
        for node in self.nodes.drain(..) {
            self.place[node as usize] = u32::MAX;
        }
    }
}

impl<'a> Index<'a> {
    pub(crate) fn new(kernel: &'a Kernel, start: &Packing, labels: &'a [u32]) -> Self {
        let mean = kernel.costs.iter().map(|cost| cost.abs()).sum::<f64>() / kernel.edge_count() as f64;
        let mut index = Self {
            kernel,
            labels,
            packed: Vec::new(),
            over: vec![Vec::new(); kernel.edge_count()],
            residual: kernel.costs.iter().map(|cost| cost.abs()).collect(),
            bound: kernel.negative_sum(),
            mean,
        };
        for packed in &start.conflicts {
            index.add(packed.clone());
        }
        index
    }

    fn add(&mut self, packed: Packed) {
        let number = self.packed.len() as u32;
        for (edge, times) in packed.conflict.uses(self.kernel) {
            self.over[edge as usize].push(number);
            let residual = &mut self.residual[edge as usize];
            *residual = (*residual - f64::from(times) * packed.weight).max(0.0);
        }
        self.bound += packed.weight * packed.conflict.least();
        self.packed.push(Some(packed));
    }

    fn paid(&self, edge: u32) -> bool {
        let (tail, head) = self.kernel.ends[edge as usize];
        (self.labels[tail as usize] == self.labels[head as usize]) == (self.kernel.costs[edge as usize] < 0.0)
    }

    /// Whether an edge is paid with capacity left, or by a conflict that pays too much.
    pub(crate) fn is_spot(&self, edge: u32) -> bool {
        let cost = self.kernel.costs[edge as usize].abs();
        self.paid(edge)
            && (self.residual[edge as usize] > CLOSED * cost
                || self.over[edge as usize].iter().any(|&number| {
                    self.packed[number as usize].as_ref().is_some_and(|packed| self.is_loose(packed))
                }))
    }

    fn is_loose(&self, packed: &Packed) -> bool {
        let uses = packed.conflict.uses(self.kernel);
        let paid: u32 = uses.iter().filter(|entry| self.paid(entry.0)).map(|entry| entry.1).sum();
        packed.weight > CLOSED * self.mean && f64::from(paid) > packed.conflict.least()
    }

    /// The graph of a window: what the conflicts inside use, and the residual.
    pub(crate) fn window(&self, ball: &Ball) -> Window {
        let inside = |node: u32| ball.place[node as usize];
        let (mut edges, mut numbers) = (Vec::new(), Vec::new());
        for &node in &ball.nodes {
            for &(other, edge) in self.kernel.arcs(node) {
                if other > node && inside(other) != u32::MAX {
                    edges.push(edge);
                    numbers.extend(self.over[edge as usize].iter().copied());
                }
            }
        }
        numbers.sort_unstable();
        numbers.dedup();
        edges.sort_unstable();
        let mut capacities: Vec<f64> = edges.iter().map(|&edge| self.residual[edge as usize]).collect();
        let mut released = Vec::new();
        let mut gained = 0.0;
        for number in numbers {
            let Some(packed) = &self.packed[number as usize] else { continue };
            let place = |node: u32| (inside(node) != u32::MAX).then(|| inside(node));
            let Some(conflict) = renamed(&packed.conflict, &place) else { continue };
            for (edge, times) in packed.conflict.uses(self.kernel) {
                if let Ok(at) = edges.binary_search(&edge) {
                    capacities[at] += f64::from(times) * packed.weight;
                }
            }
            gained += packed.weight * packed.conflict.least();
            released.push((number, Packed { conflict, weight: packed.weight }));
        }
        let cost = |edge: u32| self.kernel.costs[edge as usize];
        let local =
            edges.iter().zip(&capacities).filter(|(edge, capacity)| **capacity > SPARE * cost(**edge).abs());
        let local = local.map(|(&edge, &capacity)| {
            let (tail, head) = self.kernel.ends[edge as usize];
            (inside(tail), inside(head), capacity.copysign(cost(edge)))
        });
        let graph = SignedGraph::new(ball.nodes.len(), local);
        let labels: Vec<u32> = ball.nodes.iter().map(|&node| self.labels[node as usize]).collect();
        let (objective, bound) = (graph.objective(&labels), graph.negative_sum() + gained);
        Window { nodes: ball.nodes.clone(), graph, objective, bound, edges, capacities, released }
    }

    /// Replaces the conflicts inside a window by better ones.
    fn improve(&mut self, window: Window, budget: &mut Budget) {
        let target = window.objective - CLOSED * self.mean;
        if window.bound >= target {
            return;
        }
        let kernel = Kernel::new(&window.graph);
        let uses: Vec<_> = window.released.iter().map(|entry| entry.1.conflict.uses(&kernel)).collect();
        let weighted = window.released.iter().zip(&uses);
        let mut start = Packing::from_weights(
            &kernel,
            weighted.map(|((_, packed), uses)| (&packed.conflict, uses.as_slice(), packed.weight)),
        );
        if start.conflicts.is_empty() {
            start.extend(&kernel, u64::MAX, budget);
        }
        let mut part = budget.part(EFFORT * window.nodes.len() as u64);
        let found = solve_relaxation(&kernel, start, Vec::new(), target, |_| false, &mut part).packing;
        budget.charge(&part);
        if found.bound <= window.bound {
            return;
        }
        let nodes = window.nodes.clone();
        self.empty(window, 1.0);
        for packed in found.conflicts {
            if let Some(conflict) = renamed(&packed.conflict, &|node| nodes.get(node as usize).copied()) {
                self.add(Packed { conflict, weight: packed.weight });
            }
        }
    }

    /// Removes the conflicts inside a window, and leaves a share of all capacity there.
    fn empty(&mut self, window: Window, share: f64) {
        for (number, _) in window.released {
            let Some(packed) = self.packed[number as usize].take() else { continue };
            self.bound -= packed.weight * packed.conflict.least();
            for (edge, _) in packed.conflict.uses(self.kernel) {
                self.over[edge as usize].retain(|&other| other != number);
            }
        }
        for (&edge, &capacity) in window.edges.iter().zip(&window.capacities) {
            self.residual[edge as usize] = share * capacity;
        }
    }

    /// Gives all capacity of a window to another proof, which gains `rise` over the conflicts there.
    pub(crate) fn give(&mut self, window: Window, bound: f64) {
        let gained = bound - window.graph.negative_sum();
        self.empty(window, 0.0);
        self.bound += gained;
    }

    /// The bound, including windows that were given away.
    pub(crate) fn bound(&self) -> f64 {
        self.bound
    }

    /// The packing, with weights within capacities to the last digit.
    pub(crate) fn packing(self) -> Packing {
        let mut packing = Packing::new(self.kernel);
        for packed in self.packed.into_iter().flatten() {
            let uses = packed.conflict.uses(self.kernel);
            let weight = packed.weight.min(packing.room(&uses));
            if weight > 0.0 {
                packing.add(packed.conflict, &uses, weight);
            }
        }
        packing
    }
}

/// A conflict with other names of nodes, if all have one.
fn renamed(conflict: &Conflict, name: &impl Fn(u32) -> Option<u32>) -> Option<Conflict> {
    let all = |nodes: &[u32]| nodes.iter().map(|&node| name(node)).collect::<Option<Vec<u32>>>();
    Some(match conflict {
        Conflict::Cycle(nodes) => Conflict::Cycle(all(nodes)?),
        Conflict::Wheel(wheel) => Conflict::Wheel(Wheel {
            rim: all(&wheel.rim)?,
            spokes: wheel.spokes.iter().map(|spoke| all(spoke)).collect::<Option<_>>()?,
        }),
        Conflict::Parts(parts) => Conflict::Parts(Parts { few: all(&parts.few)?, many: all(&parts.many)? }),
    })
}

//! Local search for packings that prove a given multicut optimal.

use std::collections::VecDeque;

use super::conflict::Conflict;
use super::negotiation::Negotiation;
use super::packing::Packing;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// Steps without a better packing after which the search ends: for each edge that was not used up then, and in addition.
const PATIENCE: (usize, usize) = (12, 300);

/// The extent of a search.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Effort {
    /// Factor on the number of steps without success.
    pub(crate) patience: usize,
    /// Whether cycles that are not tight stay until they lose an edge. They pay where cycles are far from tight everywhere.
    pub(crate) keep: bool,
    /// Largest weight of a new cycle. An optimal packing may need halves of the capacities.
    pub(crate) quantum: f64,
}

/// Improves a packing by rerouting cycles, towards one that proves `labels` optimal.
///
/// A multicut pays for the edges `p`, and a packing of conflicts with weights `w_q` leaves the residual `r_e`. The objective
/// exceeds the bound by `sum_e r_e p_e + sum_q w_q (p(q) - least_q)`. So a proof uses up each edge that the multicut pays
/// for, by *tight* cycles, for which it pays once:
///
/// * an uncut repulsive edge, and a path inside its cluster;
/// * a cut attractive edge, a cut repulsive edge between the same two clusters, and two paths inside them.
///
/// Conflicts that are not tight leave the packing first, unless they are many or [`Effort::keep`] keeps their cycles. Then each step takes a paid edge with capacity left and packs the cheapest
/// tight cycle through it, even over edges that are used up: these lose other cycles, whose paid edges take their turn
/// later. Edges get dearer each time that they are contested, so cycles settle where there is room (negotiated congestion:
/// McMurchie, Ebeling, FPGA 1995). Returns the best packing on the way, or `start` if none is better.
///
/// Each step is a search inside one or two clusters.
pub(crate) fn reroute(
    kernel: &Kernel,
    start: &Packing,
    labels: &[u32],
    effort: &Effort,
    budget: &mut Budget,
) -> Packing {
    let mut routes = Routes::new(kernel, labels);
    let mut negotiation = Negotiation::new(kernel);
    let payment = |uses: &[(u32, u32)]| -> u32 {
        uses.iter().filter(|entry| routes.paid(entry.0)).map(|entry| entry.1).sum()
    };
    let cycles: Vec<_> = start
        .conflicts
        .iter()
        .filter(|packed| matches!(packed.conflict, Conflict::Cycle(_)))
        .map(|packed| (packed, packed.conflict.uses(kernel)))
        .map(|(packed, uses)| (packed, payment(&uses) == 1, uses))
        .collect();
    let loose: f64 = cycles.iter().filter(|cycle| !cycle.1).map(|cycle| cycle.0.weight).sum();
    let keep = effort.keep || loose > LOOSE * (start.bound - kernel.negative_sum());
    for (packed, tight, uses) in cycles {
        if keep || tight {
            routes.add(packed.conflict.clone(), uses, packed.weight);
        }
    }
    let edges = 0..kernel.edge_count() as u32;
    let mut turn: VecDeque<u32> = edges.filter(|&edge| routes.paid(edge) && routes.is_open(edge)).collect();
    routes.settle();
    let least = RISE * (routes.bound - kernel.negative_sum()).max(effort.quantum);
    let patience = |open: usize| effort.patience * (PATIENCE.0 * open + PATIENCE.1);
    let mut steps = patience(turn.len());
    let mut left = TOTAL * steps;
    let end = budget.spent() + effort.patience as u64 * WORK * kernel.edge_count() as u64;
    while let Some(edge) = turn.pop_front() {
        if steps == 0 || left == 0 || budget.spent() > end || budget.is_over() {
            break;
        }
        steps -= 1;
        left -= 1;
        if !routes.is_open(edge) {
            continue;
        }
        let open = |edge| routes.is_open(edge);
        let Some(nodes) = negotiation.cheapest(kernel, labels, edge, open, budget) else { continue };
        let cycle = Conflict::Cycle(nodes);
        let uses = cycle.uses(kernel);
        let weight = uses.iter().map(|entry| routes.most(entry.0)).fold(effort.quantum, f64::min);
        for &(contested, _) in &uses {
            if !routes.is_open(contested) {
                negotiation.contest(contested);
                for lost in routes.clear(contested, weight) {
                    turn.push_back(lost);
                }
            }
        }
        routes.add(cycle, uses, weight);
        if routes.is_open(edge) {
            turn.push_back(edge);
        }
        if routes.bound > routes.best + least {
            routes.settle();
            steps = patience(turn.len());
        }
    }
    routes.revert();
    let packing = routes.packing();
    if packing.bound > start.bound { packing } else { start.clone() }
}

/// A packed cycle.
struct Route {
    conflict: Conflict,
    uses: Vec<(u32, u32)>,
    weight: f64,
    active: bool,
}

/// A packing that changes, with a record of the changes since it was best.
struct Routes<'a> {
    kernel: &'a Kernel,
    labels: &'a [u32],
    all: Vec<Route>,
    /// The active routes over each edge.
    over: Vec<Vec<u32>>,
    residual: Vec<f64>,
    bound: f64,
    best: f64,
    changed: Vec<u32>,
}

/// Shares of an edge's cost below this count as used up.
const NEGLIGIBLE: f64 = 1e-12;

/// A removed cycle's remainder below this share of the room that was made is not kept.
const SPLIT: f64 = 1e-9;

/// Rises of the bound below this share of the payment are rounding errors, not success.
const RISE: f64 = 1e-9;

/// Share of the packed weight up to which cycles that are not tight leave a packing.
const LOOSE: f64 = 0.05;

/// Most work for each edge of the kernel, so that a solution far from optimal is improved before it is proved to be.
const WORK: u64 = 200;

/// Most steps in total, in multiples of the first patience: each keeps its cycle in memory.
const TOTAL: usize = 50;

impl<'a> Routes<'a> {
    fn new(kernel: &'a Kernel, labels: &'a [u32]) -> Self {
        let residual = kernel.costs.iter().map(|cost| cost.abs()).collect();
        let (over, bound) = (vec![Vec::new(); kernel.edge_count()], kernel.negative_sum());
        Self { kernel, labels, all: Vec::new(), over, residual, bound, best: bound, changed: Vec::new() }
    }

    fn paid(&self, edge: u32) -> bool {
        let (tail, head) = self.kernel.ends[edge as usize];
        let joined = self.labels[tail as usize] == self.labels[head as usize];
        joined == (self.kernel.costs[edge as usize] < 0.0)
    }

    fn is_open(&self, edge: u32) -> bool {
        self.residual[edge as usize] > NEGLIGIBLE * self.kernel.costs[edge as usize].abs()
    }

    /// The most that a new cycle can take of an edge: its residual, or all its capacity if it is used up.
    fn most(&self, edge: u32) -> f64 {
        if self.is_open(edge) { self.residual[edge as usize] } else { self.kernel.costs[edge as usize].abs() }
    }

    fn add(&mut self, conflict: Conflict, uses: Vec<(u32, u32)>, weight: f64) {
        self.all.push(Route { conflict, uses, weight, active: false });
        self.toggle(self.all.len() as u32 - 1);
    }

    /// Adds or removes a route.
    fn toggle(&mut self, index: u32) {
        let route = &mut self.all[index as usize];
        route.active = !route.active;
        let sign = if route.active { 1.0 } else { -1.0 };
        self.bound += sign * route.weight;
        for &(edge, _) in &route.uses {
            let residual = &mut self.residual[edge as usize];
            *residual = (*residual - sign * route.weight).max(0.0);
            let over = &mut self.over[edge as usize];
            if route.active {
                over.push(index);
            } else {
                over.retain(|&other| other != index);
            }
        }
        self.changed.push(index);
    }

    /// Makes room on an edge. Returns the paid edges that get capacity back.
    fn clear(&mut self, edge: u32, room: f64) -> Vec<u32> {
        let mut lost = Vec::new();
        // Where costs are not integers, the last digits decide nothing.
        while self.residual[edge as usize] < room * (1.0 - NEGLIGIBLE) {
            let Some(&index) = self.over[edge as usize].first() else { break };
            self.toggle(index);
            let uses = self.all[index as usize].uses.clone();
            lost.extend(uses.iter().map(|entry| entry.0).filter(|&edge| self.paid(edge)));
            let spare = self.residual[edge as usize] - room;
            if spare > SPLIT * room {
                let conflict = self.all[index as usize].conflict.clone();
                self.add(conflict, uses, spare);
                // Beside a heavy cycle, the room may be smaller than a rounding error, and never reached.
                break;
            }
        }
        lost
    }

    /// Remembers the present packing as the best.
    fn settle(&mut self) {
        self.best = self.bound;
        self.changed.clear();
    }

    /// Goes back to the best packing.
    fn revert(&mut self) {
        for index in std::mem::take(&mut self.changed).into_iter().rev() {
            self.toggle(index);
        }
    }

    /// The packing, with capacities used up in the order of its conflicts, as a verifier does.
    fn packing(self) -> Packing {
        let mut packing = Packing::new(self.kernel);
        for Route { conflict, uses, weight, active } in self.all {
            let weight = weight.min(packing.room(&uses));
            if active && weight > 0.0 {
                packing.add(conflict, &uses, weight);
            }
        }
        packing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::signed_graph::SignedGraph;

    /// A row of squares with both diagonals missing, and chords: only one way to pack both chords.
    fn ladder() -> Kernel {
        let rails = (0..4).flat_map(|at| [(2 * at, 2 * at + 2, 1.0), (2 * at + 1, 2 * at + 3, 1.0)]);
        let rungs = (0..5).map(|at| (2 * at, 2 * at + 1, 1.0));
        let chords = [(0, 8, -1.0), (1, 9, -1.0)];
        Kernel::new(&SignedGraph::new(10, rails.chain(rungs).chain(chords)))
    }

    const EFFORT: Effort = Effort { patience: 1, keep: false, quantum: 1.0 };

    #[test]
    fn a_cycle_in_the_way_of_two_is_rerouted() {
        let kernel = ladder();
        let mut start = Packing::new(&kernel);
        // From 0 to 8 over both rails: no room remains for the chord from 1 to 9.
        let crossing = Conflict::Cycle(vec![0, 1, 3, 5, 4, 6, 8]);
        let uses = crossing.uses(&kernel);
        start.add(crossing, &uses, 1.0);
        let labels = [0; 10];
        let packing = reroute(&kernel, &start, &labels, &EFFORT, &mut Budget::new(None, None));
        assert_eq!((start.bound, packing.bound), (-1.0, 0.0));
    }

    #[test]
    fn room_below_a_rounding_error_is_made_in_one_step() {
        let edges = [(0, 1, 1e6), (1, 2, 1e6), (0, 2, -1e6)];
        let kernel = Kernel::new(&SignedGraph::new(3, edges.into_iter()));
        let mut routes = Routes::new(&kernel, &[0; 3]);
        let cycle = Conflict::Cycle(vec![0, 1, 2]);
        let uses = cycle.uses(&kernel);
        routes.add(cycle, uses, 1e6);
        let shared = kernel.edge(0, 1).unwrap();
        assert_eq!(routes.clear(shared, 1e-11), [kernel.edge(0, 2).unwrap()]);
        assert_eq!(routes.all.len(), 2);
    }

    #[test]
    fn the_result_is_a_packing_and_no_worse_than_its_start() {
        let kernel = ladder();
        // Labels that are far from optimal mislead the search, but the bound remains one.
        for code in 0..1u32 << 10 {
            let labels: Vec<u32> = (0..10).map(|node| code >> node & 1).collect();
            let mut start = Packing::new(&kernel);
            start.extend(&kernel, u64::MAX, &mut Budget::new(None, None));
            for quantum in [0.5, 1.0] {
                let effort = Effort { quantum, keep: code % 3 == 0, ..EFFORT };
                let packing = reroute(&kernel, &start, &labels, &effort, &mut Budget::new(None, None));
                assert!(start.bound <= packing.bound && packing.bound <= 0.0);
                let mut load = vec![0.0; kernel.edge_count()];
                for packed in &packing.conflicts {
                    for (edge, times) in packed.conflict.uses(&kernel) {
                        load[edge as usize] += packed.weight * f64::from(times);
                    }
                }
                assert!(load.iter().zip(&kernel.costs).all(|(load, cost)| *load <= cost.abs()));
            }
        }
    }
}

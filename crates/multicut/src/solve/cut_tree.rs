//! Branch and cut on one kernel with one linear program throughout.
//!
//! Each case of the tree fixes the payments of some edges. Its program has cycle inequalities, odd wheels and 2-partition
//! inequalities ([`bound`](crate::bound)), all valid for every multicut, so that each of them serves in all cases. A dual
//! simplex method ([`DualSimplex`](crate::bound::dual_simplex::DualSimplex)) continues from case to case. Bounds are computed
//! from its weights by a formula that holds for any weights ([`CaseTree`]), and are never taken from the program itself.

mod branching;
mod program;

use branching::Gains;
use program::Program;

use super::rounding::rounded_solution;
use crate::bound::cut::Cut;
use crate::bound::dual_simplex::End;
use crate::bound::odd_wheel_separation::WheelSeparation;
use crate::bound::packing::Packed;
use crate::bound::{hard_cycles, parts_separation};
use crate::budget::Budget;
use crate::certificate::tree::{Case, CaseTree, Weights};
use crate::graph::kernel::Kernel;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;

/// Violations of cycles up to this value are errors of the point.
const VIOLATION: f64 = 1e-6;

/// Payments this close to 0 or 1 count as integral.
const INTEGRAL: f64 = 1e-6;

/// Rounds of wheels and 2-partitions in a row that may close less than [`PROGRESS`] of the gap: at the root, and below.
const PATIENCE: (usize, usize) = (4, 1);

/// Share of the gap that a round should close.
const PROGRESS: f64 = 0.02;

/// What is asked of the tree.
pub(super) struct Task<'a> {
    pub(super) graph: &'a SignedGraph,
    pub(super) kernel: &'a Kernel,
    /// Inequalities to start with.
    pub(super) start: &'a [Packed],
    /// The bound that suffices.
    pub(super) cutoff: f64,
    /// Gap that counts as closed.
    pub(super) tolerance: f64,
    pub(super) record: bool,
}

/// What the tree found.
pub(super) struct Found {
    /// The best labels and their objective.
    pub(super) labels: Vec<u32>,
    pub(super) objective: f64,
    pub(super) bound: f64,
    pub(super) proof: Option<CaseTree>,
}

/// A case to be examined: its place in the proof, what it fixes, and the bound of the case around it.
struct Open {
    case: usize,
    fixed: Vec<(u32, bool)>,
    bound: f64,
}

struct Search<'a> {
    task: &'a Task<'a>,
    program: Program<'a>,
    labels: Vec<u32>,
    objective: f64,
    cases: Vec<Case>,
    /// The least bound of finished cases.
    closed: f64,
    open: Vec<Open>,
    gains: Gains,
}

/// Searches until no multicut is left below the cutoff or the best objective, or the budget is over.
pub(super) fn search(task: &Task, labels: Vec<u32>, objective: f64, budget: &mut Budget) -> Found {
    let mut search = Search {
        task,
        program: Program::new(task.kernel),
        labels,
        objective,
        cases: vec![Case::Leaf(Weights::new())],
        closed: f64::INFINITY,
        open: vec![Open { case: 0, fixed: Vec::new(), bound: task.kernel.negative_sum() }],
        gains: Gains::new(task.kernel.edge_count()),
    };
    for packed in task.start {
        search.program.add(Cut::Conflict(packed.conflict.clone()));
    }
    while let Some(open) = search.open.pop() {
        if budget.is_over() || search.is_good(open.bound) {
            search.finish(open.bound);
            continue;
        }
        search.examine(open, budget);
    }
    Found {
        labels: search.labels,
        objective: search.objective,
        bound: search.closed,
        proof: task.record.then_some(CaseTree { cuts: search.program.cuts, cases: search.cases }),
    }
}

impl Search<'_> {
    fn goal(&self) -> f64 {
        self.task.cutoff.min(self.objective - self.task.tolerance)
    }

    fn is_good(&self, bound: f64) -> bool {
        self.task.kernel.rounded(bound) >= self.goal()
    }

    fn finish(&mut self, bound: f64) {
        self.closed = self.closed.min(self.task.kernel.rounded(bound));
    }

    fn offer(&mut self, labels: Vec<u32>) {
        let objective = self.task.graph.objective(&labels);
        if objective < self.objective {
            (self.objective, self.labels) = (objective, labels);
        }
    }

    /// Bounds a case, and closes it or splits it.
    fn examine(&mut self, open: Open, budget: &mut Budget) {
        self.program.fix(&open.fixed);
        let root = open.case == 0 && open.fixed.is_empty();
        let mut best = (open.bound, None);
        let (mut before, mut idle) = (f64::NEG_INFINITY, 0);
        loop {
            let (kernel, goal) = (self.task.kernel, self.goal());
            let good = |bound: f64| kernel.rounded(bound) >= goal;
            let end = self.program.run(good, budget);
            let weights = self.program.weights(end, good);
            let (bound, reduced) = self.program.bound(&weights);
            if bound > best.0 || best.1.is_none() {
                if self.task.record {
                    self.cases[open.case] = Case::Leaf(weights.clone());
                }
                best = (bound.max(best.0), Some((weights, reduced, bound)));
            }
            if good(best.0) || end != End::Optimal {
                return self.finish(best.0);
            }
            let paid = self.program.simplex.values().to_vec();
            let mut cuts = hard_cycles::violated(kernel, &paid, &self.program.fixed, VIOLATION, budget);
            if cuts.is_empty() {
                let fractional = |value: &f64| *value > INTEGRAL && *value < 1.0 - INTEGRAL;
                if !paid.iter().any(fractional) {
                    self.offer(joined(kernel, &paid));
                    return self.finish(best.0);
                }
                if self.program.simplex.objective() < before + PROGRESS * (goal - bound) {
                    idle += 1;
                } else {
                    idle = 0;
                }
                before = self.program.simplex.objective();
                if root || idle == 0 {
                    self.offer(rounded_solution(self.task.graph, kernel, &paid, budget));
                }
                if idle < if root { PATIENCE.0 } else { PATIENCE.1 } {
                    cuts.extend(self.conflicts(&paid, budget));
                }
            }
            let mut added = false;
            for cut in cuts {
                added |= self.program.add(cut);
            }
            self.program.purge();
            if !added {
                break;
            }
        }
        let Some((weights, reduced, bound)) = best.1 else { return };
        self.split(open, best.0, (weights, reduced, bound), budget);
    }

    fn conflicts(&self, paid: &[f64], budget: &mut Budget) -> Vec<Cut> {
        let kernel = self.task.kernel;
        let mut found = WheelSeparation::new(kernel).violated(paid, budget);
        found.extend(parts_separation::violated(kernel, paid, budget));
        found.into_iter().map(Cut::Conflict).collect()
    }

    /// Fixes edges by their reduced costs, and makes two cases of one edge.
    fn split(
        &mut self,
        open: Open,
        bound: f64,
        (weights, reduced, proved): (Weights, Vec<f64>, f64),
        budget: &mut Budget,
    ) {
        let Open { mut case, mut fixed, .. } = open;
        let kernel = self.task.kernel;
        let mut by_cost = Vec::new();
        for (edge, &reduced) in reduced.iter().enumerate() {
            if self.program.fixed[edge].is_none() && self.is_good(proved + reduced.abs()) {
                by_cost.push((edge as u32, reduced < 0.0));
                self.finish(proved + reduced.abs());
            }
        }
        let values = self.program.simplex.values();
        let by_cost: Vec<(u32, bool)> = by_cost
            .into_iter()
            .filter(|&(edge, paid)| (values[edge as usize] - f64::from(u8::from(paid))).abs() < 0.5)
            .collect();
        if !by_cost.is_empty() {
            fixed.extend_from_slice(&by_cost);
            if self.task.record {
                let rest = self.cases.len();
                self.cases.push(Case::Leaf(weights.clone()));
                let edges = by_cost.iter().map(|&(edge, paid)| (kernel.ends[edge as usize], paid)).collect();
                self.cases[case] = Case::Fix { weights: weights.clone(), edges, rest };
                case = rest;
            }
            self.program.fix(&fixed);
        }
        let Some((edge, order)) = self.choose_edge(budget) else { return self.finish(bound) };
        let first = self.cases.len();
        if self.task.record {
            self.cases.extend([Case::Leaf(weights.clone()), Case::Leaf(weights)]);
            self.cases[case] = Case::Split { edge: kernel.ends[edge as usize], cases: [first, first + 1] };
        }
        // The last one is examined first.
        for paid in order {
            let mut fixed = fixed.clone();
            fixed.push((edge, paid));
            let case = if self.task.record { first + usize::from(paid) } else { 0 };
            self.open.push(Open { case, fixed, bound });
        }
    }
}

/// The clusters of an integral point: ends of attractive edges that are not paid belong together.
fn joined(kernel: &Kernel, paid: &[f64]) -> Vec<u32> {
    let mut sets = UnionFind::new(kernel.node_count());
    for (edge, &(tail, head)) in kernel.ends.iter().enumerate() {
        if kernel.costs[edge] > 0.0 && paid[edge] < 0.5 {
            sets.union(tail, head);
        }
    }
    sets.labels()
}

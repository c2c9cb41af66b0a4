//! The cycle relaxation, strengthened by odd wheels: a linear program to which violated inequalities are added.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::conflict::Conflict;
use super::cycle_separation::CycleSeparation;
use super::interior_point::{Point, Row, minimise_covering};
use super::odd_wheel_separation::WheelSeparation;
use super::packing::Packing;
use super::parts_separation;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// The best packing found, and a point of the relaxation.
#[derive(Debug, Clone)]
pub(crate) struct Relaxation {
    pub(crate) packing: Packing,
    /// The payment of each edge: `y` for an attractive edge, `1 - y` for a repulsive one.
    pub(crate) paid: Vec<f64>,
    /// Whether no cycle inequality is violated any more.
    pub(crate) converged: bool,
    /// The inequalities of the last program.
    pub(crate) conflicts: Vec<Conflict>,
}

impl Relaxation {
    /// A packing with no point, and what a program would start from.
    pub(crate) fn of(kernel: &Kernel, packing: Packing, known: Vec<Conflict>) -> Self {
        let Program { conflicts, .. } = Program::of(kernel, &packing).with(kernel, known);
        Self { conflicts, ..Self::new(kernel, packing) }
    }

    fn new(kernel: &Kernel, packing: Packing) -> Self {
        Self { packing, paid: vec![0.0; kernel.edge_count()], converged: false, conflicts: Vec::new() }
    }
}

/// The inequalities of the program.
struct Program {
    conflicts: Vec<Conflict>,
    /// The edges of each conflict, and how often they count.
    uses: Vec<Vec<(u32, u32)>>,
    /// Hashes of the edges that each conflict uses. A collision only loses one row.
    known: HashSet<u64>,
}

impl Program {
    fn of(kernel: &Kernel, packing: &Packing) -> Self {
        let mut program = Self { conflicts: Vec::new(), uses: Vec::new(), known: HashSet::new() };
        for packed in &packing.conflicts {
            program.add(kernel, packed.conflict.clone());
        }
        program
    }

    fn with(mut self, kernel: &Kernel, conflicts: Vec<Conflict>) -> Self {
        for conflict in conflicts {
            self.add(kernel, conflict);
        }
        self
    }

    fn add(&mut self, kernel: &Kernel, conflict: Conflict) -> bool {
        let uses = conflict.uses(kernel);
        let new = self.known.insert(hash(&uses));
        if new {
            self.conflicts.push(conflict);
            self.uses.push(uses);
        }
        new
    }

    /// The linear program in the form that the interior point method takes.
    fn covering(&self, kernel: &Kernel) -> Covering {
        // Only edges in some conflict are variables; the others are paid nothing.
        let mut column = vec![u32::MAX; kernel.edge_count()];
        let mut costs = Vec::new();
        let rows = self
            .uses
            .iter()
            .zip(&self.conflicts)
            .map(|(uses, conflict)| {
                let entries = uses.iter().map(|&(edge, times)| {
                    let place = &mut column[edge as usize];
                    if *place == u32::MAX {
                        *place = costs.len() as u32;
                        costs.push(kernel.costs[edge as usize].abs());
                    }
                    (*place, times as f32)
                });
                Row { entries: entries.collect(), least: conflict.least() }
            })
            .collect();
        Covering { column, costs, rows }
    }

    /// The packing by the dual weights, extended by cycles that still fit. Weights below a share of `scale` are rounding errors.
    fn packing(&self, kernel: &Kernel, point: &Point, scale: f64, budget: &mut Budget) -> Packing {
        let weighted = self.conflicts.iter().zip(&self.uses).zip(&point.weights);
        let weighted = weighted.map(|((conflict, uses), &weight)| (conflict, uses.as_slice(), weight));
        let mut packing = Packing::from_weights(kernel, weighted.filter(|entry| entry.2 > NOTHING * scale));
        packing.extend(kernel, u64::MAX, budget);
        packing
    }

    /// Drops inequalities that are far from tight and have a weight within the point's error: they hold anyway. Small
    /// programs make cheap steps.
    fn drop_slack(&mut self, covering: &Covering, point: &Point, accuracy: f64) {
        let keep: Vec<bool> = covering
            .rows
            .iter()
            .zip(&point.weights)
            .map(|(row, &weight)| {
                row.value(&point.values) < row.least + 0.5
                    || weight > accuracy * 0.01 * covering.costs[row.entries[0].0 as usize]
            })
            .collect();
        self.retain(|index| keep[index]);
    }

    /// Keeps the conflicts for which `keep` holds at their position.
    fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let mut index = 0;
        self.conflicts.retain(|_| {
            index += 1;
            keep(index - 1)
        });
        index = 0;
        let known = &mut self.known;
        self.uses.retain(|uses| {
            index += 1;
            let kept = keep(index - 1);
            if !kept {
                known.remove(&hash(uses));
            }
            kept
        });
    }
}

/// A program over the edges that its inequalities use.
struct Covering {
    /// For each edge its variable, `u32::MAX` if it has none.
    column: Vec<u32>,
    costs: Vec<f64>,
    rows: Vec<Row>,
}

impl Covering {
    /// Writes the payment of each edge at a point.
    fn pay(&self, point: &Point, paid: &mut [f64]) {
        for (paid, &place) in paid.iter_mut().zip(&self.column) {
            *paid = if place == u32::MAX { 0.0 } else { point.values[place as usize] };
        }
    }

    /// The bound of the dual point: the sum of negative costs, plus the weight of each inequality times its right-hand side.
    fn bound(&self, kernel: &Kernel, point: &Point) -> f64 {
        let weighted = self.rows.iter().zip(&point.weights);
        kernel.negative_sum() + weighted.map(|(row, weight)| row.least * weight).sum::<f64>()
    }
}

fn hash(uses: &[(u32, u32)]) -> u64 {
    let mut sorted = uses.to_vec();
    sorted.sort_unstable();
    let mut hasher = DefaultHasher::new();
    sorted.hash(&mut hasher);
    hasher.finish()
}

/// Gaps at which points are accurate enough, as shares of the payment. An early point lies near the middle of the feasible
/// set, where violated inequalities cut deep, so the accuracy rises only when no more are found.
const FIRST_ACCURACY: f64 = 1e-2;
const REFINEMENT: f64 = 1e-2;
const LAST_ACCURACY: f64 = 1e-9;

/// An inequality counts as violated by more than this share of the accuracy, and by more than a rounding error. Smaller
/// violations are errors of the point.
const VIOLATION: f64 = 0.1;
const LEAST_VIOLATION: f64 = 1e-7;

/// Accuracy of a point from which wheels are separated. Their separation takes the point for exact; it is complete at one that
/// violates no cycle.
const FINE: f64 = 2e-6;

/// Rounds that may close next to nothing before points become fine and wheels are looked for, although some cycles are still
/// violated. Where the cycle relaxation has reached its value, hundreds of cycles may remain that only move the point along the
/// optimal face. Much earlier, before cycles hold the point, there are too many wheels.
const IDLE: usize = 14;

/// Most rounds of wheel separation.
const ROUNDS: usize = 20;

/// Dual weights below this share of the payment are rounding errors.
const NOTHING: f64 = 1e-11;

/// A bound that rises by less than this share of all costs counts as unchanged.
const RISE: f64 = 1e-9;

/// Solves `min c^+ y + |c^-| (1 - y)` over the cycle inequalities (Chopra, Rao 1993): for each repulsive edge `f` and each
/// attractive path `P` between its ends, `y(P) + (1 - y_f) >= 1`. Cycles with other numbers of repulsive edges do not change
/// the optimum (Lange, Karrenbauer, Andres, ICML 2018). So this is a covering program, its dual packs cycles, and every dual
/// point is a certificate. When a point violates no cycle inequality, odd wheel inequalities follow ([`WheelSeparation`])
/// and 2-partition inequalities ([`parts_separation`]); they are covering inequalities too. They also follow when many rounds
/// of cycles have not raised the bound. An inequality counts only if the point violates it, so their separation may be heuristic.
///
/// Starts from the conflicts of `start` and `known`. Ends when no inequality is violated, when the bound reaches `target`, when
/// the budget is over, or when the bound hardly rises any more and `give_up` finds the packing good enough. Early rounds stop far
/// from the optimum, where cuts are deep.
pub(crate) fn solve_relaxation(
    kernel: &Kernel,
    start: Packing,
    known: Vec<Conflict>,
    target: f64,
    give_up: impl Fn(&Packing) -> bool,
    budget: &mut Budget,
) -> Relaxation {
    let mut program = Program::of(kernel, &start).with(kernel, known);
    let mut restarted_at = start.bound;
    let magnitude: f64 = kernel.costs.iter().map(|cost| cost.abs()).sum();
    let mut relaxation = Relaxation::new(kernel, start);
    let mut separation = CycleSeparation::new(kernel);
    let mut rounds = 0;
    let mut accuracy = FIRST_ACCURACY;
    let mut progress = Progress::default();
    let mut last_bound = f64::NEG_INFINITY;
    while !budget.is_over() && !program.conflicts.is_empty() {
        let covering = program.covering(kernel);
        // The relevant gap is relative to the payment, not to the sum of all costs.
        let scale = (relaxation.packing.bound - kernel.negative_sum()).max(magnitude * 1e-6);
        let Some(point) = minimise_covering(&covering.costs, &covering.rows, accuracy * scale, budget) else {
            break;
        };
        let accurate = point.gap <= accuracy * scale;
        covering.pay(&point, &mut relaxation.paid);
        let packing = program.packing(kernel, &point, scale, budget);
        if packing.bound > relaxation.packing.bound {
            relaxation.packing = packing;
        }
        if kernel.rounded(relaxation.packing.bound) >= target {
            break;
        }
        progress.missing.push(target - relaxation.packing.bound);
        if progress.has_stalled() {
            if give_up(&relaxation.packing) {
                break;
            }
            // If extending the packing gained more than the weights alone, restart from its conflicts: they make the better
            // program.
            if relaxation.packing.bound > restarted_at {
                restarted_at = relaxation.packing.bound;
                progress.restarted = progress.missing.len();
                program = Program::of(kernel, &relaxation.packing);
                continue;
            }
        }
        let idle = progress.is_idle();
        if idle && accurate {
            accuracy = accuracy.min(FINE);
        }
        let least = (accuracy * VIOLATION).max(LEAST_VIOLATION);
        let mut violated = separation.violated(&relaxation.paid, least, budget);
        if (idle || violated.is_empty()) && point.gap <= FINE * scale && rounds < ROUNDS {
            rounds += 1;
            violated = WheelSeparation::new(kernel).violated(&relaxation.paid, budget);
            violated.extend(parts_separation::violated(kernel, &relaxation.paid, budget));
        }
        let bound = covering.bound(kernel, &point);
        if accurate && bound > last_bound + RISE * magnitude {
            // The bound rises, so dropped cycles cannot return for ever.
            last_bound = bound;
            program.drop_slack(&covering, &point, accuracy);
        }
        let mut added = false;
        for conflict in violated {
            added |= program.add(kernel, conflict);
        }
        if !added {
            if accuracy <= LAST_ACCURACY || !accurate {
                relaxation.converged = accurate;
                break;
            }
            accuracy = (accuracy * REFINEMENT).max(LAST_ACCURACY);
        }
    }
    relaxation.conflicts = program.conflicts;
    relaxation
}

/// How far the bound was from the target after each round.
#[derive(Default)]
struct Progress {
    missing: Vec<f64>,
    /// Number of rounds before the last restart.
    restarted: usize,
}

impl Progress {
    /// Whether three rounds since the last restart have closed less than a twentieth of the distance to the target.
    fn has_stalled(&self) -> bool {
        matches!(self.missing[self.restarted..], [.., before, _, _, now] if now > 0.95 * before)
    }

    /// Whether [`IDLE`] rounds, restarts included, have closed less than a hundredth of the distance.
    fn is_idle(&self) -> bool {
        let window = self.missing.len().checked_sub(IDLE + 1).map(|first| &self.missing[first..]);
        matches!(window, Some([before, .., now]) if *now > 0.99 * before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_rounds_without_a_better_bound_are_idle_even_across_restarts() {
        let mut progress = Progress { missing: vec![3.0; IDLE], restarted: 0 };
        assert!(progress.has_stalled() && !progress.is_idle());
        progress.restarted = IDLE;
        progress.missing.push(2.99);
        assert!(!progress.has_stalled() && progress.is_idle());
        progress.missing.push(2.9);
        assert!(!progress.is_idle());
    }
}

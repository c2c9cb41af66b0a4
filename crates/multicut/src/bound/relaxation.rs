//! The cycle relaxation, strengthened by odd wheels: a linear program whose inequalities are found as they are violated.

use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash, Hasher};

use super::conflict::Conflict;
use super::cycle_separation::CycleSeparation;
use super::interior_point::{Row, minimise_covering};
use super::odd_wheel_separation::WheelSeparation;
use super::packing::Packing;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// The best packing found, and a point of the relaxation.
#[derive(Debug, Clone)]
pub(crate) struct Relaxation {
    pub(crate) packing: Packing,
    /// How much each edge's cost is paid: `y` for an attractive edge, `1 - y` for a repulsive one.
    pub(crate) paid: Vec<f64>,
    /// Whether no cycle inequality is violated any more.
    pub(crate) converged: bool,
}

/// The inequalities of the program.
struct Program {
    conflicts: Vec<Conflict>,
    /// The edges of each, and how often they count.
    uses: Vec<Vec<(u32, u32)>>,
    /// Hashes of what each uses; two that share one by chance cost a row, nothing else.
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

    fn add(&mut self, kernel: &Kernel, conflict: Conflict) -> bool {
        let uses = conflict.uses(kernel);
        let new = self.known.insert(hash(&uses));
        if new {
            self.conflicts.push(conflict);
            self.uses.push(uses);
        }
        new
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

fn hash(uses: &[(u32, u32)]) -> u64 {
    let mut sorted = uses.to_vec();
    sorted.sort_unstable();
    let mut hasher = DefaultHasher::new();
    sorted.hash(&mut hasher);
    hasher.finish()
}

/// Accuracy of a point from which on wheels are looked for: among cycles that it violates, none is left.
const FINE: f64 = 2e-6;

/// Rounds of wheels.
const ROUNDS: usize = 20;

/// Solves `min c^+ y + |c^-| (1 - y)` over the cycle inequalities (Chopra, Rao 1993): for each repulsive edge `f` and each
/// attractive path `P` between its ends, `y(P) + (1 - y_f) >= 1`. Cycles with other numbers of repulsive edges do not change
/// the optimum (Lange, Karrenbauer, Andres, ICML 2018), so this is a covering program, and its dual packs cycles:
/// every dual point is a certificate. When no cycle inequality is violated any more, odd wheel inequalities are
/// ([`WheelSeparation`]); they are covering inequalities too.
///
/// Starts from the conflicts of `start`, and ends when no inequality is violated, when the bound reaches `target`, or with
/// the budget, or when the bound has all but ceased to rise and `give_up` finds the packing good enough. Early rounds stop far from the optimum, where
/// cuts are deep.
pub(crate) fn solve_relaxation(
    kernel: &Kernel,
    start: Packing,
    target: f64,
    give_up: impl Fn(&Packing) -> bool,
    budget: &mut Budget,
) -> Relaxation {
    let mut program = Program::of(kernel, &start);
    let mut restarted_at = start.bound;
    let magnitude: f64 = kernel.costs.iter().map(|cost| cost.abs()).sum();
    let mut relaxation =
        Relaxation { packing: start, paid: vec![0.0; kernel.edge_count()], converged: false };
    let mut separation = CycleSeparation::new(kernel);
    let mut rounds = 0;
    let mut accuracy = 1e-2;
    let mut missing = Vec::new();
    let mut last_bound = f64::NEG_INFINITY;
    while !budget.is_over() && !program.conflicts.is_empty() {
        // Only edges on some cycle are variables; the others are paid nothing.
        let mut column = vec![u32::MAX; kernel.edge_count()];
        let mut costs = Vec::new();
        let rows: Vec<Row> = program
            .uses
            .iter()
            .zip(&program.conflicts)
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
        // The gap that matters is relative to what is paid, not to the sum of all costs.
        let scale = (relaxation.packing.bound - kernel.negative_sum()).max(magnitude * 1e-6);
        let Some(point) = minimise_covering(&costs, &rows, accuracy * scale, budget) else { break };
        for (edge, &place) in column.iter().enumerate() {
            relaxation.paid[edge] = if place == u32::MAX { 0.0 } else { point.values[place as usize] };
        }
        let weighted = program.conflicts.iter().zip(&program.uses).zip(&point.weights);
        let weighted = weighted.map(|((conflict, uses), &weight)| (conflict, uses.as_slice(), weight));
        let mut packing = Packing::from_weights(kernel, weighted.filter(|entry| entry.2 > 1e-11 * scale));
        packing.extend(kernel, u64::MAX, budget);
        if packing.bound > relaxation.packing.bound {
            relaxation.packing = packing;
        }
        if kernel.rounded(relaxation.packing.bound) >= target {
            break;
        }
        missing.push(target - relaxation.packing.bound);
        if let [.., before, _, _, now] = missing[..]
            && now > 0.95 * before
        {
            if give_up(&relaxation.packing) {
                break;
            }
            // Where packing what the weights left brought more than the weights themselves, its conflicts make the
            // better program.
            if relaxation.packing.bound > restarted_at {
                restarted_at = relaxation.packing.bound;
                missing.clear();
                program = Program::of(kernel, &relaxation.packing);
                continue;
            }
        }
        let least = (accuracy * 0.1).max(1e-7);
        let mut violated = separation.violated(&relaxation.paid, least, budget);
        if violated.is_empty() && accuracy <= FINE && rounds < ROUNDS && point.gap <= accuracy * scale {
            rounds += 1;
            violated = WheelSeparation::new(kernel).violated(&relaxation.paid, budget);
        }
        if point.gap <= accuracy * scale
            && point_bound(kernel, &rows, &point.weights) > last_bound + 1e-9 * magnitude
        {
            // The bound rises, so dropped cycles cannot come back for ever.
            last_bound = point_bound(kernel, &rows, &point.weights);
            let keep: Vec<bool> = rows
                .iter()
                .zip(&point.weights)
                .map(|(row, &weight)| {
                    row.value(&point.values) < row.least + 0.5
                        || weight > accuracy * 0.01 * costs[row.entries[0].0 as usize]
                })
                .collect();
            program.retain(|index| keep[index]);
        }
        let mut added = false;
        for conflict in violated {
            added |= program.add(kernel, conflict);
        }
        if !added {
            if accuracy <= 1e-9 || point.gap > accuracy * scale {
                relaxation.converged = point.gap <= accuracy * scale;
                break;
            }
            accuracy *= 1e-2;
            if accuracy < 1e-9 {
                accuracy = 1e-9;
            }
        }
    }
    relaxation
}

fn point_bound(kernel: &Kernel, rows: &[Row], weights: &[f64]) -> f64 {
    kernel.negative_sum() + rows.iter().zip(weights).map(|(row, weight)| row.least * weight).sum::<f64>()
}

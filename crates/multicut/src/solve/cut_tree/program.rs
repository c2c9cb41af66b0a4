//! The linear program of the tree: inequalities in use, and bounds that do not rest on its accuracy.

use std::collections::HashMap;

use crate::bound::cut::Cut;
use crate::bound::dual_simplex::{DualSimplex, End};
use crate::budget::Budget;
use crate::certificate::tree::Weights;
use crate::graph::kernel::Kernel;

/// An inequality's edges with coefficients, and the least value of their sum.
type Row = (Vec<(u32, f64)>, f64);

/// Rows of the program beyond twice the tight ones that are kept although they are not tight.
const SPARE: usize = 200;

/// Rows with less slack than this are kept.
const CLOSE: f64 = 0.25;

pub(super) struct Program<'a> {
    pub(super) kernel: &'a Kernel,
    pub(super) simplex: DualSimplex,
    /// Every inequality ever added, and its row.
    pub(super) cuts: Vec<Cut>,
    rows: Vec<Row>,
    /// Numbers of inequalities by their sorted edges and coefficients.
    known: HashMap<Vec<(u32, i32)>, u32>,
    /// Whether an inequality is in the program, and the inequality of each of its rows.
    used: Vec<bool>,
    cut_of_row: Vec<u32>,
    /// Of each edge, whether its payment is fixed, and at which value.
    pub(super) fixed: Vec<Option<bool>>,
}

/// Largest share by which integer costs are lowered.
const LOWERED: f64 = 1e-5;

/// The costs of payments. Integer costs make many optima alike, among which the simplex method would wander; each is lowered
/// by a tiny, different share. That costs little of a bound, and bounds round up.
fn costs(kernel: &Kernel) -> Vec<f64> {
    let share = |edge: usize| (edge as f64 * 0.618_033_988_749_894_8).fract();
    let lowered = |edge: usize| if kernel.integral { 1.0 - LOWERED * share(edge) } else { 1.0 };
    kernel.costs.iter().enumerate().map(|(edge, cost)| cost.abs() * lowered(edge)).collect()
}

impl<'a> Program<'a> {
    pub(super) fn new(kernel: &'a Kernel) -> Self {
        Self {
            kernel,
            simplex: DualSimplex::new(costs(kernel)),
            cuts: Vec::new(),
            rows: Vec::new(),
            known: HashMap::new(),
            used: Vec::new(),
            cut_of_row: Vec::new(),
            fixed: vec![None; kernel.edge_count()],
        }
    }

    /// Adds an inequality; false if the program has it already.
    pub(super) fn add(&mut self, cut: Cut) -> bool {
        let (entries, least) = cut.row(self.kernel);
        let mut key: Vec<(u32, i32)> = entries.iter().map(|&(edge, a)| (edge, a as i32)).collect();
        key.sort_unstable();
        let count = self.cuts.len() as u32;
        let number = *self.known.entry(key).or_insert(count);
        if number == count {
            self.cuts.push(cut);
            self.rows.push((entries, least));
            self.used.push(false);
        }
        if std::mem::replace(&mut self.used[number as usize], true) {
            return false;
        }
        let (entries, least) = &self.rows[number as usize];
        self.simplex.add_row(entries.clone(), *least);
        self.cut_of_row.push(number);
        true
    }

    /// Fixes exactly these payments.
    pub(super) fn fix(&mut self, fixed: &[(u32, bool)]) {
        for edge in 0..self.fixed.len() {
            if self.fixed[edge].take().is_some() {
                self.simplex.set_bounds(edge as u32, 0.0, 1.0);
            }
        }
        for &(edge, paid) in fixed {
            self.fixed[edge as usize] = Some(paid);
            let value = f64::from(u8::from(paid));
            self.simplex.set_bounds(edge, value, value);
        }
    }

    /// Solves the program as far as `good` bounds allow; `good` decides on a bound.
    pub(super) fn run(&mut self, good: impl Fn(f64) -> bool, budget: &mut Budget) -> End {
        let negative = self.kernel.negative_sum();
        self.simplex.run(|objective| good(negative + objective), u64::MAX, budget)
    }

    /// The weights after a run. If the program is infeasible, they are moved along the ray until their bound is `good`.
    pub(super) fn weights(&self, end: End, good: impl Fn(f64) -> bool) -> Weights {
        let weights: Weights =
            self.simplex.weights().map(|(row, weight)| (self.cut_of_row[row as usize], weight)).collect();
        if end != End::Infeasible {
            return weights;
        }
        let mut base: HashMap<u32, f64> = weights.iter().copied().collect();
        for _ in 0..60 {
            for &(row, value) in self.simplex.ray() {
                let weight = base.entry(self.cut_of_row[row as usize]).or_insert(0.0);
                *weight += value * self.kernel.costs.iter().map(|cost| cost.abs()).fold(0.0, f64::max);
            }
            let mut moved: Weights = base
                .iter()
                .map(|(&cut, &weight)| (cut, weight.max(0.0)))
                .filter(|entry| entry.1 > 0.0)
                .collect();
            moved.sort_unstable_by_key(|entry| entry.0);
            if good(self.bound(&moved).0) {
                return moved;
            }
        }
        weights
    }

    /// The bound that weights prove in the present case, and the edges' reduced costs. Any weights that are not negative give
    /// a valid bound.
    pub(super) fn bound(&self, weights: &Weights) -> (f64, Vec<f64>) {
        let mut reduced: Vec<f64> = self.kernel.costs.iter().map(|cost| cost.abs()).collect();
        let mut bound = self.kernel.negative_sum();
        for &(cut, weight) in weights {
            let (entries, least) = &self.rows[cut as usize];
            bound += weight * least;
            for &(edge, a) in entries {
                reduced[edge as usize] -= weight * a;
            }
        }
        for (reduced, fixed) in reduced.iter().zip(&self.fixed) {
            bound += match fixed {
                None => reduced.min(0.0),
                Some(true) => *reduced,
                Some(false) => 0.0,
            };
        }
        (bound, reduced)
    }

    /// Drops rows that are far from tight if there are many.
    pub(super) fn purge(&mut self) {
        if self.simplex.row_count() < 2 * self.simplex.tight_count() + SPARE {
            return;
        }
        let slack: Vec<bool> =
            (0..self.simplex.row_count() as u32).map(|row| self.simplex.slack(row) < CLOSE).collect();
        let kept = self.simplex.purge(|row| slack[row as usize]);
        let mut stays = vec![false; self.cut_of_row.len()];
        for &row in &kept {
            stays[row as usize] = true;
        }
        for (row, &cut) in self.cut_of_row.iter().enumerate() {
            self.used[cut as usize] = stays[row];
        }
        self.cut_of_row = kept.iter().map(|&row| self.cut_of_row[row as usize]).collect();
    }
}

//! Which edge to split a case by.

use super::{INTEGRAL, Search};
use crate::bound::dual_simplex::End;
use crate::budget::Budget;

/// By how much fixing an edge raised the objective, for each unit of change, summed over trials, and the number of trials;
/// unpaid and paid.
pub(super) struct Gains {
    sums: Vec<[f64; 2]>,
    counts: Vec<[u32; 2]>,
}

/// Trials of an edge after which their mean is trusted.
const RELIABLE: u32 = 2;

/// Most edges that are tried for one case, and most pivots of a trial.
const TRIALS: usize = 12;
const PIVOTS: u64 = 40;

/// Trials in a row that may bring nothing better.
const PATIENCE: usize = 5;

/// Stands for no gain in products.
const LITTLE: f64 = 1e-7;

impl Gains {
    pub(super) fn new(edges: usize) -> Self {
        Self { sums: vec![[0.0; 2]; edges], counts: vec![[0; 2]; edges] }
    }

    fn record(&mut self, edge: u32, paid: bool, gain: f64) {
        self.sums[edge as usize][usize::from(paid)] += gain;
        self.counts[edge as usize][usize::from(paid)] += 1;
    }

    fn is_reliable(&self, edge: u32) -> bool {
        self.counts[edge as usize].iter().all(|&count| count >= RELIABLE)
    }

    /// Expected gains of both cases of an edge with a given payment; `each` stands in for edges without trials.
    fn expected(&self, edge: u32, payment: f64, each: f64) -> [f64; 2] {
        let per_unit = |side: usize| {
            let count = self.counts[edge as usize][side];
            if count == 0 { each } else { self.sums[edge as usize][side] / f64::from(count) }
        };
        [per_unit(0) * payment, per_unit(1) * (1.0 - payment)]
    }
}

fn score(gains: [f64; 2]) -> f64 {
    gains[0].max(LITTLE) * gains[1].max(LITTLE)
}

impl Search<'_> {
    /// The edge with the largest product of gains (reliability branching: Achterberg, Koch, Martin 2005), and the order of its
    /// cases: the more promising one last. `None` if all payments are integral.
    pub(super) fn choose_edge(&mut self, budget: &mut Budget) -> Option<(u32, [bool; 2])> {
        let costs = &self.task.kernel.costs;
        let values = self.program.simplex.values().to_vec();
        let mut candidates: Vec<(f64, u32)> = (0..values.len() as u32)
            .filter(|&edge| (INTEGRAL..=1.0 - INTEGRAL).contains(&values[edge as usize]))
            .map(|edge| {
                let each = costs[edge as usize].abs();
                (score(self.gains.expected(edge, values[edge as usize], each)), edge)
            })
            .collect();
        candidates.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut best: Option<(f64, u32, [f64; 2])> = None;
        let (mut tried, mut idle) = (0, 0);
        for (guess, edge) in candidates {
            let payment = values[edge as usize];
            let (score, gains) = if self.gains.is_reliable(edge) {
                (guess, self.gains.expected(edge, payment, 0.0))
            } else if tried < TRIALS && idle < PATIENCE && !budget.is_over() {
                tried += 1;
                let gains = [self.trial(edge, false, budget), self.trial(edge, true, budget)];
                if gains.contains(&f64::INFINITY) {
                    return Some((
                        edge,
                        if gains[0] == f64::INFINITY { [true, false] } else { [false, true] },
                    ));
                }
                (score(gains), gains)
            } else {
                continue;
            };
            if best.is_none_or(|best| score > best.0) {
                best = Some((score, edge, gains));
                idle = 0;
            } else {
                idle += 1;
            }
        }
        let (_, edge, gains) = best?;
        Some((edge, if gains[0] <= gains[1] { [true, false] } else { [false, true] }))
    }

    /// By how much the objective rises in a few pivots if an edge is fixed; infinite if that closes the case.
    fn trial(&mut self, edge: u32, paid: bool, budget: &mut Budget) -> f64 {
        let mut simplex = self.program.simplex.clone();
        let value = f64::from(u8::from(paid));
        let (before, payment) = (simplex.objective(), simplex.values()[edge as usize]);
        simplex.set_bounds(edge, value, value);
        let negative = self.task.kernel.negative_sum();
        let end = simplex.run(|objective| self.is_good(negative + objective), PIVOTS, budget);
        if matches!(end, End::Enough | End::Infeasible) {
            return f64::INFINITY;
        }
        let gain = (simplex.objective() - before).max(0.0);
        self.gains.record(edge, paid, gain / if paid { 1.0 - payment } else { payment });
        gain
    }
}

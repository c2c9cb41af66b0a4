//! The ratio test: which variable or row enters the basis.

use super::{DualSimplex, FEASIBLE, NONE};
use crate::budget::Budget;

/// What enters the basis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Entering {
    Column(u32),
    /// The row at this place among the tight ones, which ceases to be tight.
    Slack(usize),
}

/// The result of a ratio test.
pub(super) struct Chosen {
    pub(super) entering: Option<Entering>,
    /// Its coefficient.
    pub(super) pivot: f64,
    /// Dual step.
    pub(super) step: f64,
    /// Variables that go to their other bound.
    pub(super) flips: Vec<u32>,
}

/// Coefficients below this value are no pivots.
const SMALLEST: f64 = 1e-9;

/// Ratios that differ by no more than this share of the mean cost count as equal: among these, the largest pivot is taken.
const EQUAL: f64 = 1e-10;

impl DualSimplex {
    /// Coefficients `a` of variables outside the basis in the row `a` that leaves, times `sign`: those of `entries`, minus
    /// `left` times the tight rows. Returns the variables with a coefficient; the others' entries stay 0.
    pub(super) fn coefficients(
        &self,
        entries: &[(u32, f64)],
        left: &[f64],
        sign: f64,
        budget: &mut Budget,
    ) -> Vec<(u32, f64)> {
        let mut sums = vec![0.0; self.costs.len()];
        let mut touched = Vec::new();
        let mut work = entries.len();
        let mut seen = vec![false; self.costs.len()];
        let mut add = |column: u32, value: f64| {
            if !std::mem::replace(&mut seen[column as usize], true) {
                touched.push(column);
            }
            sums[column as usize] += value;
        };
        for &(column, a) in entries {
            add(column, a);
        }
        for (&row, &factor) in self.tight.iter().zip(left) {
            if factor.abs() > 1e-13 {
                let entries = &self.rows[row as usize].entries;
                work += entries.len();
                for &(column, a) in entries {
                    add(column, -factor * a);
                }
            }
        }
        budget.spend(work as u64 / 4);
        touched.retain(|&column| {
            self.column_place[column as usize] == NONE && sums[column as usize].abs() > SMALLEST
        });
        touched.into_iter().map(|column| (column, sign * sums[column as usize])).collect()
    }

    /// Bound flipping ratio test (Maros 2003): passes variables that go from one bound to the other while the dual objective
    /// still rises. `missing` is how far the leaving variable is out of bounds.
    pub(super) fn choose(
        &self,
        coefficients: &[(u32, f64)],
        left: &[f64],
        sign: f64,
        missing: f64,
    ) -> Chosen {
        // Ratio, pivot, what enters.
        let mut breaks: Vec<(f64, f64, Entering)> = Vec::new();
        for &(column, a) in coefficients {
            let index = column as usize;
            if self.lower[index] == self.upper[index] {
                continue;
            }
            let at_upper = self.values[index] > self.lower[index];
            let reduced = self.reduced[index];
            if (a > 0.0) != at_upper {
                breaks.push(((reduced / a).max(0.0), a, Entering::Column(column)));
            }
        }
        for (place, &factor) in left.iter().enumerate() {
            if sign * factor > SMALLEST {
                let a = sign * factor;
                breaks.push(((self.weights[place] / a).max(0.0), a, Entering::Slack(place)));
            }
        }
        breaks.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(order(x.2).cmp(&order(y.2))));
        let mut slope = missing;
        let mut passed = 0;
        while let Some(&(_, a, entering)) = breaks.get(passed) {
            slope -= match entering {
                Entering::Column(column) => {
                    a.abs() * (self.upper[column as usize] - self.lower[column as usize])
                }
                Entering::Slack(_) => f64::INFINITY,
            };
            if slope < FEASIBLE {
                break;
            }
            passed += 1;
        }
        let Some(&(ratio, ..)) = breaks.get(passed) else {
            return Chosen { entering: None, pivot: 0.0, step: 0.0, flips: Vec::new() };
        };
        // Among nearly equal ratios take the largest pivot, for accuracy; those before it flip.
        let near = |entry: &(f64, f64, Entering)| (entry.0 - ratio).abs() <= EQUAL * (1.0 + ratio);
        let first = (0..=passed).rev().take_while(|&place| near(&breaks[place])).last().unwrap_or(passed);
        let last = (passed..breaks.len()).take_while(|&place| near(&breaks[place])).last().unwrap_or(passed);
        let best = (first..=last)
            .max_by(|&x, &y| breaks[x].1.abs().total_cmp(&breaks[y].1.abs()).then(y.cmp(&x)))
            .unwrap_or(passed);
        let flips = (0..passed)
            .filter(|&place| place != best && breaks[place].0 < breaks[best].0)
            .filter_map(|place| match breaks[place].2 {
                Entering::Column(column) => Some(column),
                Entering::Slack(_) => None,
            })
            .collect();
        Chosen { entering: Some(breaks[best].2), pivot: breaks[best].1, step: breaks[best].0, flips }
    }
}

/// Any fixed order of what may enter.
fn order(entering: Entering) -> (u8, usize) {
    match entering {
        Entering::Column(column) => (0, column as usize),
        Entering::Slack(place) => (1, place),
    }
}

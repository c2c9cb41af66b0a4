//! One step of the method: what leaves, and the exchange.

use super::ratio::Entering;
use super::{DualSimplex, FEASIBLE, NONE};
use crate::budget::Budget;

/// What leaves the basis, and by how much it is out of bounds.
#[derive(Debug, Clone, Copy)]
pub(super) enum Leaving {
    /// The variable at this place in the basis; the sign is that of the change it needs.
    Column { place: usize, sign: f64, missing: f64 },
    /// A violated row.
    Row { row: u32, missing: f64 },
}

/// Candidates whose norms are computed anew before one is chosen.
const EXACT: usize = 16;

/// Stands in for norms that are nearly 0.
const SMALLEST_NORM: f64 = 1e-6;

fn square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum()
}

/// Pivots below this value need a fresh inverse.
const UNSURE: f64 = 1e-7;

impl DualSimplex {
    /// The variable in the basis or the row that is furthest out of bounds, relative to the norm of its row in the inverse of
    /// the whole basis (dual steepest edge; Forrest, Goldfarb 1992). Norms are remembered from when they were computed last;
    /// those of the most promising few are computed anew.
    pub(super) fn leaving(&mut self) -> Option<Leaving> {
        let mut candidates: Vec<(f64, u32, Leaving)> = Vec::new();
        for (place, &column) in self.basic.iter().enumerate() {
            let index = column as usize;
            let value = self.values[index];
            let (missing, sign) = if value < self.lower[index] {
                (self.lower[index] - value, 1.0)
            } else {
                (value - self.upper[index], -1.0)
            };
            if missing > FEASIBLE {
                let score = missing * missing / self.column_norm[index];
                candidates.push((score, column, Leaving::Column { place, sign, missing }));
            }
        }
        for (row, &slack) in self.slack.iter().enumerate() {
            if slack < -FEASIBLE && self.row_place[row] == NONE {
                let score = slack * slack / self.row_norm[row];
                candidates.push((score, row as u32, Leaving::Row { row: row as u32, missing: -slack }));
            }
        }
        if candidates.len() > EXACT {
            candidates.select_nth_unstable_by(EXACT - 1, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            candidates.truncate(EXACT);
        }
        let exact = candidates.into_iter().map(|(_, number, leaving)| {
            let score = match leaving {
                Leaving::Column { place, missing, .. } => {
                    let norm = square(self.inverse.row(place)).max(SMALLEST_NORM);
                    self.column_norm[self.basic[place] as usize] = norm;
                    missing * missing / norm
                }
                Leaving::Row { row, missing } => {
                    let norm = 1.0 + square(&self.left_of_row(row));
                    self.row_norm[row as usize] = norm;
                    missing * missing / norm
                }
            };
            (score, number, leaving)
        });
        exact.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))).map(|best| best.2)
    }

    /// Exchanges what leaves for what enters. `Some(false)` if nothing can enter, `None` if the pivot would be inaccurate.
    pub(super) fn pivot(&mut self, leaving: Leaving, budget: &mut Budget) -> Option<bool> {
        let (sign, missing) = match leaving {
            Leaving::Column { sign, missing, .. } => (sign, missing),
            Leaving::Row { missing, .. } => (1.0, missing),
        };
        let left = match leaving {
            Leaving::Column { place, .. } => self.inverse.row(place).to_vec(),
            Leaving::Row { row, .. } => self.left_of_row(row),
        };
        let entries: &[(u32, f64)] = match leaving {
            Leaving::Column { .. } => &[],
            Leaving::Row { row, .. } => &self.rows[row as usize].entries,
        };
        let coefficients = self.coefficients(entries, &left, sign, budget);
        let chosen = self.choose(&coefficients, &left, sign, missing);
        budget.spend((self.inverse.size() * self.inverse.size() / 16 + self.slack.len() / 4) as u64);
        let Some(entering) = chosen.entering else {
            self.ray = self.tight.iter().zip(&left).map(|(&row, value)| (row, -sign * value)).collect();
            if let Leaving::Row { row, .. } = leaving {
                self.ray.push((row, 1.0));
            }
            return Some(false);
        };
        if chosen.pivot.abs() < UNSURE {
            return None;
        }
        self.pivots += 1;
        self.flip(&chosen.flips);
        // Weights and reduced costs.
        for (weight, value) in self.weights.iter_mut().zip(&left) {
            *weight -= chosen.step * sign * value;
        }
        for &(column, a) in &coefficients {
            self.reduced[column as usize] -= chosen.step * a;
        }
        let column = match entering {
            Entering::Column(column) => self.right_of_column(column),
            Entering::Slack(place) => {
                (0..self.inverse.size()).map(|row| self.inverse.row(row)[place]).collect()
            }
        };
        self.move_values(leaving, entering, &column, sign, chosen.pivot);
        self.exchange(leaving, entering, &column, &left, sign, chosen.pivot, chosen.step);
        Some(true)
    }

    /// Moves variables to their other bounds, and the basis with them.
    fn flip(&mut self, flips: &[u32]) {
        if flips.is_empty() {
            return;
        }
        let mut right = vec![0.0; self.inverse.size()];
        for &column in flips {
            let index = column as usize;
            let to =
                if self.values[index] > self.lower[index] { self.lower[index] } else { self.upper[index] };
            let change = to - self.values[index];
            for &(row, a) in &self.columns[index] {
                let place = self.row_place[row as usize];
                if place != NONE {
                    right[place as usize] -= a * change;
                }
            }
            self.change(column, change);
        }
        let right: Vec<(usize, f64)> = right.into_iter().enumerate().filter(|entry| entry.1 != 0.0).collect();
        let changes = self.inverse.right(&right);
        for (place, change) in changes.into_iter().enumerate() {
            self.change(self.basic[place], change);
        }
    }

    /// Changes a variable's value and the slacks of its rows.
    fn change(&mut self, column: u32, change: f64) {
        if change == 0.0 {
            return;
        }
        self.values[column as usize] += change;
        for &(row, a) in &self.columns[column as usize] {
            self.slack[row as usize] += a * change;
        }
    }

    /// Moves along the edge of the polytope until the leaving variable or row is at its bound.
    fn move_values(&mut self, leaving: Leaving, entering: Entering, column: &[f64], sign: f64, pivot: f64) {
        let missing = match leaving {
            Leaving::Column { place, .. } => {
                let index = self.basic[place] as usize;
                if sign > 0.0 {
                    self.lower[index] - self.values[index]
                } else {
                    self.values[index] - self.upper[index]
                }
            }
            Leaving::Row { row, .. } => -self.slack[row as usize],
        };
        let step = missing / pivot;
        let direction = match entering {
            Entering::Column(_) => -step,
            Entering::Slack(_) => step,
        };
        for (place, value) in column.iter().enumerate() {
            if value.abs() > 1e-14 {
                self.change(self.basic[place], direction * value);
            }
        }
        match entering {
            Entering::Column(entering) => self.change(entering, step),
            Entering::Slack(place) => self.slack[self.tight[place] as usize] = step,
        }
        match leaving {
            Leaving::Column { place, .. } => {
                let index = self.basic[place] as usize;
                self.values[index] = if sign > 0.0 { self.lower[index] } else { self.upper[index] };
            }
            Leaving::Row { row, .. } => self.slack[row as usize] = 0.0,
        }
    }

    #[expect(clippy::too_many_arguments, reason = "the parts of one exchange")]
    fn exchange(
        &mut self,
        leaving: Leaving,
        entering: Entering,
        column: &[f64],
        left: &[f64],
        sign: f64,
        pivot: f64,
        step: f64,
    ) {
        match (leaving, entering) {
            (Leaving::Row { row, .. }, Entering::Column(entering)) => {
                self.inverse.grow(column, left, pivot);
                self.enter_both(row, entering);
                self.reduced[entering as usize] = 0.0;
                if let Some(weight) = self.weights.last_mut() {
                    *weight = step;
                }
            }
            (Leaving::Row { row, .. }, Entering::Slack(place)) => {
                self.inverse.replace_row(place, left);
                self.row_place[self.tight[place] as usize] = NONE;
                self.row_place[row as usize] = place as u32;
                self.tight[place] = row;
                self.weights[place] = step;
            }
            (Leaving::Column { place, .. }, Entering::Column(entering)) => {
                self.inverse.replace_column(place, column);
                self.leave(place, sign * step);
                self.column_place[entering as usize] = place as u32;
                self.basic[place] = entering;
                self.reduced[entering as usize] = 0.0;
            }
            (Leaving::Column { place, .. }, Entering::Slack(slack)) => {
                self.inverse.shrink(place, slack);
                self.leave(place, sign * step);
                self.row_place[self.tight[slack] as usize] = NONE;
                self.basic.swap_remove(place);
                self.tight.swap_remove(slack);
                self.weights.swap_remove(slack);
                if let Some(&moved) = self.basic.get(place) {
                    self.column_place[moved as usize] = place as u32;
                }
                if let Some(&moved) = self.tight.get(slack) {
                    self.row_place[moved as usize] = slack as u32;
                }
            }
        }
    }

    fn leave(&mut self, place: usize, reduced: f64) {
        let column = self.basic[place] as usize;
        self.column_place[column] = NONE;
        self.reduced[column] = reduced;
    }
}

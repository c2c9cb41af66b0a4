//! A dual simplex method for small programs to which inequalities are added and whose variables are fixed and freed.

mod inverse;
mod pivot;
mod ratio;

use inverse::Inverse;

use crate::budget::Budget;

/// A variable or inequality that is not in the basis.
const NONE: u32 = u32::MAX;

/// Values may leave their bounds, and inequalities be violated, by this much.
const FEASIBLE: f64 = 1e-9;

/// How a run of the method ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum End {
    /// At the optimum.
    Optimal,
    /// At a dual point that is good enough.
    Enough,
    /// No point satisfies the inequalities within the bounds. The weights, moved along the last direction, prove any bound.
    Infeasible,
    /// Too many pivots, or the budget is over; the weights are valid all the same.
    Stopped,
}

#[derive(Debug, Clone)]
struct Row {
    entries: Vec<(u32, f64)>,
    least: f64,
}

/// Minimises `costs * x` subject to `a x >= b` for each row and bounds on each variable.
///
/// Every variable has finite bounds, so every basis becomes dual feasible if each variable outside it stands at the bound
/// that its reduced cost prefers (boxed dual simplex; Maros 2003). That stays true when rows are added and bounds change, so
/// each run continues from where the last one ended.
///
/// Of the basis matrix only the part of tight rows and variables in the basis is inverted, as a dense matrix of size `k`; the
/// other rows follow. A pivot costs `O(k^2)` at most and less where the inverse is sparse.
#[derive(Debug, Clone)]
pub(crate) struct DualSimplex {
    costs: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    values: Vec<f64>,
    /// Reduced costs of variables outside the basis, 0 inside.
    reduced: Vec<f64>,
    rows: Vec<Row>,
    /// The rows of each variable, with coefficients.
    columns: Vec<Vec<(u32, f64)>>,
    /// `a x - b` of each row.
    slack: Vec<f64>,
    /// Tight rows and the variables in the basis, in the order of the inverse, and their places there.
    tight: Vec<u32>,
    basic: Vec<u32>,
    row_place: Vec<u32>,
    column_place: Vec<u32>,
    /// Dual weights of tight rows.
    weights: Vec<f64>,
    inverse: Inverse,
    /// Squared norms of the rows of the inverse of the whole basis, as they were computed last.
    row_norm: Vec<f64>,
    column_norm: Vec<f64>,
    /// Direction in which the weights prove infeasibility.
    ray: Vec<(u32, f64)>,
    pub(crate) pivots: u64,
}

impl DualSimplex {
    /// A program without inequalities, with variables between 0 and 1.
    pub(crate) fn new(costs: Vec<f64>) -> Self {
        let count = costs.len();
        Self {
            lower: vec![0.0; count],
            upper: vec![1.0; count],
            values: vec![0.0; count],
            reduced: costs.clone(),
            rows: Vec::new(),
            columns: vec![Vec::new(); count],
            slack: Vec::new(),
            tight: Vec::new(),
            basic: Vec::new(),
            row_place: Vec::new(),
            column_place: vec![NONE; count],
            weights: Vec::new(),
            inverse: Inverse::default(),
            row_norm: Vec::new(),
            column_norm: vec![1.0; count],
            ray: Vec::new(),
            pivots: 0,
            costs,
        }
    }

    pub(crate) fn add_row(&mut self, entries: Vec<(u32, f64)>, least: f64) -> u32 {
        let index = self.rows.len() as u32;
        for &(column, coefficient) in &entries {
            self.columns[column as usize].push((index, coefficient));
        }
        self.rows.push(Row { entries, least });
        self.row_place.push(NONE);
        self.slack.push(0.0);
        self.row_norm.push(1.0);
        index
    }

    pub(crate) fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// Number of tight rows.
    pub(crate) fn tight_count(&self) -> usize {
        self.tight.len()
    }

    pub(crate) fn slack(&self, row: u32) -> f64 {
        self.slack[row as usize]
    }

    pub(crate) fn is_tight(&self, row: u32) -> bool {
        self.row_place[row as usize] != NONE
    }

    pub(crate) fn set_bounds(&mut self, column: u32, lower: f64, upper: f64) {
        self.lower[column as usize] = lower;
        self.upper[column as usize] = upper;
    }

    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Tight rows and their weights, none negative.
    pub(crate) fn weights(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.tight
            .iter()
            .zip(&self.weights)
            .filter(|entry| *entry.1 > 0.0)
            .map(|(&row, &weight)| (row, weight))
    }

    /// The direction in which weights prove infeasibility, after [`End::Infeasible`]; it may have negative entries.
    pub(crate) fn ray(&self) -> &[(u32, f64)] {
        &self.ray
    }

    pub(crate) fn objective(&self) -> f64 {
        self.costs.iter().zip(&self.values).map(|(cost, value)| cost * value).sum()
    }

    /// Drops rows that are not tight and for which `keep` is false. Returns the old numbers of the remaining rows.
    pub(crate) fn purge(&mut self, keep: impl Fn(u32) -> bool) -> Vec<u32> {
        let kept: Vec<u32> =
            (0..self.rows.len() as u32).filter(|&row| self.is_tight(row) || keep(row)).collect();
        let mut number = vec![NONE; self.rows.len()];
        for (new, &old) in kept.iter().enumerate() {
            number[old as usize] = new as u32;
        }
        for column in &mut self.columns {
            column.retain_mut(|entry| {
                entry.0 = number[entry.0 as usize];
                entry.0 != NONE
            });
        }
        for row in &mut self.tight {
            *row = number[*row as usize];
        }
        let mut index = 0;
        self.rows.retain(|_| {
            index += 1;
            number[index - 1] != NONE
        });
        self.row_place = kept.iter().map(|&old| self.row_place[old as usize]).collect();
        self.row_norm = kept.iter().map(|&old| self.row_norm[old as usize]).collect();
        self.slack = kept.iter().map(|&old| self.slack[old as usize]).collect();
        kept
    }

    /// Runs until the optimum, until `enough` accepts the objective, or for at most `pivots` pivots.
    pub(crate) fn run(&mut self, enough: impl Fn(f64) -> bool, pivots: u64, budget: &mut Budget) -> End {
        self.refresh(budget);
        let end = self.pivots.saturating_add(pivots);
        loop {
            if enough(self.objective()) {
                return End::Enough;
            }
            let Some(leaving) = self.leaving() else { return End::Optimal };
            if self.pivots >= end || budget.is_over() {
                return End::Stopped;
            }
            match self.pivot(leaving, budget) {
                Some(true) => {}
                Some(false) => return End::Infeasible,
                None => {
                    // The pivot would be inaccurate. Build the inverse anew; if that does not help, give up.
                    if !self.refactor(budget) {
                        return End::Stopped;
                    }
                    self.refresh(budget);
                    let Some(leaving) = self.leaving() else { return End::Optimal };
                    match self.pivot(leaving, budget) {
                        Some(true) => {}
                        Some(false) => return End::Infeasible,
                        None => return End::Stopped,
                    }
                }
            }
        }
    }

    /// Recomputes weights, reduced costs and values from the basis, so that errors do not add up.
    fn refresh(&mut self, budget: &mut Budget) {
        self.recompute();
        if self.residual() > 1e-8 && self.refactor(budget) {
            self.recompute();
        }
        let size = self.inverse.size();
        let entries: usize = self.rows.iter().map(|row| row.entries.len()).sum();
        budget.spend((2 * size * size / 16 + entries) as u64);
    }

    fn recompute(&mut self) {
        let costs = self.basic.iter().map(|&column| self.costs[column as usize]);
        self.weights = self.inverse.left(costs.enumerate());
        self.reduced.copy_from_slice(&self.costs);
        for (&row, &weight) in self.tight.iter().zip(&self.weights) {
            for &(column, coefficient) in &self.rows[row as usize].entries {
                self.reduced[column as usize] -= coefficient * weight;
            }
        }
        for column in 0..self.costs.len() {
            if self.column_place[column] == NONE {
                self.values[column] =
                    if self.reduced[column] < 0.0 { self.upper[column] } else { self.lower[column] };
            } else {
                self.reduced[column] = 0.0;
            }
        }
        let right: Vec<f64> = (self.tight.iter())
            .map(|&row| {
                let Row { entries, least } = &self.rows[row as usize];
                let outside = entries.iter().filter(|entry| self.column_place[entry.0 as usize] == NONE);
                least - outside.map(|&(column, a)| a * self.values[column as usize]).sum::<f64>()
            })
            .collect();
        for (&column, value) in self.basic.iter().zip(self.inverse.right_dense(&right)) {
            self.values[column as usize] = value;
        }
        for (slack, row) in self.slack.iter_mut().zip(&self.rows) {
            let value: f64 = row.entries.iter().map(|&(column, a)| a * self.values[column as usize]).sum();
            *slack = value - row.least;
        }
    }

    /// By how much tight rows miss their right-hand sides.
    fn residual(&self) -> f64 {
        self.tight.iter().map(|&row| self.slack[row as usize].abs()).fold(0.0, f64::max)
    }

    /// Inverts the basis anew; false if it is singular to working precision, and then the basis is empty.
    fn refactor(&mut self, budget: &mut Budget) -> bool {
        let (tight, mut basic) = (std::mem::take(&mut self.tight), std::mem::take(&mut self.basic));
        self.inverse = Inverse::default();
        self.weights.clear();
        for &row in &tight {
            self.row_place[row as usize] = NONE;
        }
        for &column in &basic {
            self.column_place[column as usize] = NONE;
        }
        budget.spend((tight.len().pow(3) / 16) as u64);
        let mut complete = true;
        for row in tight {
            // Of the remaining variables, take the one with the largest pivot.
            let left = self.left_of_row(row);
            let best = (0..basic.len())
                .map(|place| (self.pivot_of(row, &left, basic[place]), place))
                .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()).then(b.1.cmp(&a.1)));
            let Some((pivot, place)) = best.filter(|best| best.0.abs() > 1e-7) else {
                complete = false;
                continue;
            };
            let column = basic.swap_remove(place);
            let right = self.right_of_column(column);
            self.inverse.grow(&right, &left, pivot);
            self.enter_both(row, column);
        }
        complete
    }

    fn enter_both(&mut self, row: u32, column: u32) {
        self.row_place[row as usize] = self.tight.len() as u32;
        self.column_place[column as usize] = self.basic.len() as u32;
        self.tight.push(row);
        self.basic.push(column);
        self.weights.push(0.0);
    }

    /// A row's coefficients of variables in the basis, times the inverse.
    fn left_of_row(&self, row: u32) -> Vec<f64> {
        let entries = self.rows[row as usize].entries.iter();
        let inside = entries.filter(|entry| self.column_place[entry.0 as usize] != NONE);
        self.inverse.left(inside.map(|&(column, a)| (self.column_place[column as usize] as usize, a)))
    }

    /// The inverse times a variable's coefficients in tight rows.
    fn right_of_column(&self, column: u32) -> Vec<f64> {
        let entries = self.columns[column as usize].iter();
        let inside: Vec<(usize, f64)> = entries
            .filter(|entry| self.is_tight(entry.0))
            .map(|&(row, a)| (self.row_place[row as usize] as usize, a))
            .collect();
        self.inverse.right(&inside)
    }

    /// The coefficient of a variable in a row, after elimination of the basis.
    fn pivot_of(&self, row: u32, left: &[f64], column: u32) -> f64 {
        let mut pivot = 0.0;
        for &(other, a) in &self.columns[column as usize] {
            if other == row {
                pivot += a;
            } else if self.is_tight(other) {
                pivot -= a * left[self.row_place[other as usize] as usize];
            }
        }
        pivot
    }
}

#[cfg(test)]
mod tests;

//! Linear programs of covering type, by a primal-dual interior point method.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::LltError;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side};

use crate::budget::Budget;

/// A point of the central path near the optimum.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// Feasible primal values.
    pub(crate) values: Vec<f64>,
    /// Feasible dual weights, one a row.
    pub(crate) weights: Vec<f64>,
    /// Objective of `values` minus objective of `weights`.
    pub(crate) gap: f64,
}

/// Most Newton steps; usual are 10 to 30.
const STEPS: usize = 100;

/// Most entries of a factor: one gigabyte. Larger programs keep the bound they have.
const LARGEST_FACTOR: usize = 1 << 27;

/// Newton steps in a row that may bring no progress.
const PATIENCE: usize = 8;

/// Minimises `costs * x` subject to `sum of x over each row >= 1`, `x >= 0`, with positive costs, until the gap is
/// at most `tolerance`; the dual packs the rows into capacities `costs`.
///
/// Mehrotra's predictor-corrector method (SIAM J. Optimization 2(4), 1992), started from a strictly feasible pair, so
/// that every iterate gives a valid bound. The Newton system is reduced to the primal variables and solved by a
/// sparse Cholesky factorisation on one thread: results do not depend on threads. Rows of a cycle linear program hold one
/// repulsive edge each, so those variables never meet one another, and elimination leaves a system of the size of the
/// attractive edges. `None` if the factorisation fails or memory is short.
pub(crate) fn minimise_covering(
    costs: &[f64],
    rows: &[Vec<u32>],
    tolerance: f64,
    budget: &mut Budget,
) -> Option<Point> {
    let mut system = NewtonSystem::new(costs.len(), rows)?;
    // Rows hold two variables at least, so x = 1 leaves slack 1 at least.
    let mut values = vec![1.0; costs.len()];
    let mut load = vec![0u32; costs.len()];
    for &column in rows.iter().flatten() {
        load[column as usize] += 1;
    }
    let share = |column: u32| 0.5 * costs[column as usize] / f64::from(load[column as usize]);
    let mut weights: Vec<f64> = rows
        .iter()
        .map(|row| row.iter().map(|&column| share(column)).fold(f64::INFINITY, f64::min))
        .collect();
    let mut point = Point { gap: f64::INFINITY, values: values.clone(), weights: weights.clone() };
    let mut stalled = 0;
    for _ in 0..STEPS {
        let slack: Vec<f64> = cover(rows, &values).iter().map(|covered| covered - 1.0).collect();
        let mut reduced = costs.to_vec();
        for (row, &weight) in rows.iter().zip(&weights) {
            for &column in row {
                reduced[column as usize] -= weight;
            }
        }
        if slack.iter().chain(&reduced).any(|value| *value <= 0.0) {
            break;
        }
        let gap = dot(costs, &values) - weights.iter().sum::<f64>();
        if gap < point.gap {
            point = Point { gap, values: values.clone(), weights: weights.clone() };
            stalled = 0;
        } else {
            // A step may first lead back to the centre.
            stalled += 1;
        }
        if gap <= tolerance || stalled > PATIENCE || !budget.spend(system.work()) {
            break;
        }
        let count = (costs.len() + rows.len()) as f64;
        let mean = (dot(&slack, &weights) + dot(&reduced, &values)) / count;
        if system.factorise(&values, &reduced, &slack, &weights).is_err() {
            break;
        }
        // Predictor: straight to the optimum.
        let affine = system.direction(
            &State { values: &values, slack: &slack, weights: &weights },
            &|index| -weights[index] * slack[index],
            &|index| -values[index] * reduced[index],
        );
        let (primal, dual) = affine.lengths(&values, &reduced, &slack, &weights, 1.0);
        let ahead =
            (0..rows.len())
                .map(|i| (slack[i] + primal * affine.slack[i]) * (weights[i] + dual * affine.weights[i]))
                .chain((0..costs.len()).map(|j| {
                    (values[j] + primal * affine.values[j]) * (reduced[j] + dual * affine.reduced[j])
                }))
                .sum::<f64>()
                / count;
        let centre = mean * (ahead / mean).powi(3);
        // Corrector: towards the centre, with the second-order term of the predictor.
        let step = system.direction(
            &State { values: &values, slack: &slack, weights: &weights },
            &|i| centre - weights[i] * slack[i] - affine.slack[i] * affine.weights[i],
            &|j| centre - values[j] * reduced[j] - affine.values[j] * affine.reduced[j],
        );
        let (primal, dual) = step.lengths(&values, &reduced, &slack, &weights, 0.995);
        for (value, change) in values.iter_mut().zip(&step.values) {
            *value += primal * change;
        }
        for (weight, change) in weights.iter_mut().zip(&step.weights) {
            *weight += dual * change;
        }
    }
    point.gap.is_finite().then_some(point)
}

fn cover(rows: &[Vec<u32>], values: &[f64]) -> Vec<f64> {
    rows.iter().map(|row| row.iter().map(|&column| values[column as usize]).sum()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

struct State<'a> {
    values: &'a [f64],
    slack: &'a [f64],
    weights: &'a [f64],
}

struct Direction {
    values: Vec<f64>,
    reduced: Vec<f64>,
    slack: Vec<f64>,
    weights: Vec<f64>,
}

impl Direction {
    /// Longest primal and dual steps, at most 1, that keep `damping` of the way to the boundary.
    fn lengths(
        &self,
        values: &[f64],
        reduced: &[f64],
        slack: &[f64],
        weights: &[f64],
        damping: f64,
    ) -> (f64, f64) {
        let longest = |at: &[f64], change: &[f64]| {
            at.iter()
                .zip(change)
                .filter(|(_, change)| **change < 0.0)
                .map(|(at, change)| -damping * at / change)
                .fold(1.0, f64::min)
        };
        (
            longest(values, &self.values).min(longest(slack, &self.slack)),
            longest(reduced, &self.reduced).min(longest(weights, &self.weights)),
        )
    }
}

/// `diag(r / x) + A' diag(w / s) A`, its pattern, factor and scratch.
struct NewtonSystem<'a> {
    rows: &'a [Vec<u32>],
    pattern: SymbolicSparseColMat<usize>,
    /// Where each product of two entries of a row adds up, row by row.
    places: Vec<u32>,
    diagonal: Vec<u32>,
    matrix: Vec<f64>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    scratch: MemBuffer,
}

impl<'a> NewtonSystem<'a> {
    fn new(columns: usize, rows: &'a [Vec<u32>]) -> Option<Self> {
        let pair = |a: u32, b: u32| (u64::from(a.min(b)) << 32) | u64::from(a.max(b));
        let mut pairs: Vec<u64> = (0..columns as u32).map(|column| pair(column, column)).collect();
        for row in rows {
            for (index, &a) in row.iter().enumerate() {
                pairs.extend(row[index + 1..].iter().map(|&b| pair(a, b)));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        // Lower triangle: the smaller index is the column.
        let mut starts = vec![0usize; columns + 1];
        for &entry in &pairs {
            starts[(entry >> 32) as usize + 1] += 1;
        }
        for column in 0..columns {
            starts[column + 1] += starts[column];
        }
        let find = |a: u32, b: u32| -> Option<u32> {
            let column = a.min(b) as usize;
            let range = &pairs[starts[column]..starts[column + 1]];
            range.binary_search(&pair(a, b)).ok().map(|place| (starts[column] + place) as u32)
        };
        let mut places = Vec::new();
        for row in rows {
            for (index, &a) in row.iter().enumerate() {
                for &b in &row[index + 1..] {
                    places.push(find(a, b)?);
                }
            }
        }
        let diagonal = (0..columns as u32).map(|column| find(column, column)).collect::<Option<_>>()?;
        let row_indices: Vec<usize> = pairs.iter().map(|entry| (entry & 0xffff_ffff) as usize).collect();
        let matrix = vec![0.0; pairs.len()];
        let pattern = SymbolicSparseColMat::new_checked(columns, columns, starts, None, row_indices);
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .ok()?;
        if symbolic.len_val() > LARGEST_FACTOR {
            return None;
        }
        let request = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, faer::Spec::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let scratch = MemBuffer::try_new(request).ok()?;
        let factor = vec![0.0; symbolic.len_val()];
        Some(Self { rows, pattern, places, diagonal, matrix, symbolic, factor, scratch })
    }

    /// Work of one step, in visited entries: a fill of `k` a column costs about `k` operations an entry.
    fn work(&self) -> u64 {
        let columns = self.diagonal.len().max(1) as u64;
        let fill = self.factor.len() as u64;
        self.places.len() as u64 + fill + fill * (fill / columns) / 64
    }

    fn factorise(
        &mut self,
        values: &[f64],
        reduced: &[f64],
        slack: &[f64],
        weights: &[f64],
    ) -> Result<(), LltError> {
        self.matrix.fill(0.0);
        for (column, &place) in self.diagonal.iter().enumerate() {
            self.matrix[place as usize] = reduced[column] / values[column];
        }
        let mut places = self.places.iter();
        for (row, (slack, weight)) in self.rows.iter().zip(slack.iter().zip(weights)) {
            let scale = weight / slack;
            for &column in row {
                self.matrix[self.diagonal[column as usize] as usize] += scale;
            }
            for &place in places.by_ref().take(row.len() * (row.len() - 1) / 2) {
                self.matrix[place as usize] += scale;
            }
        }
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), &self.matrix);
        self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            matrix,
            Side::Lower,
            faer::linalg::cholesky::llt::factor::LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.scratch),
            faer::Spec::default(),
        )?;
        Ok(())
    }

    /// The Newton direction for complementarity right-hand sides of rows and columns.
    fn direction(
        &mut self,
        state: &State,
        row_target: &dyn Fn(usize) -> f64,
        column_target: &dyn Fn(usize) -> f64,
    ) -> Direction {
        let row_targets: Vec<f64> = (0..self.rows.len()).map(row_target).collect();
        let column_targets: Vec<f64> = (0..state.values.len()).map(column_target).collect();
        let mut values: Vec<f64> =
            column_targets.iter().zip(state.values).map(|(target, value)| target / value).collect();
        for (index, row) in self.rows.iter().enumerate() {
            let term = row_targets[index] / state.slack[index];
            for &column in row {
                values[column as usize] += term;
            }
        }
        let count = values.len();
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut values, count, 1),
            Par::Seq,
            MemStack::new(&mut self.scratch),
        );
        let slack = cover(self.rows, &values);
        let weights: Vec<f64> = (0..self.rows.len())
            .map(|i| (row_targets[i] - state.weights[i] * slack[i]) / state.slack[i])
            .collect();
        let mut reduced = vec![0.0; values.len()];
        for (row, weight) in self.rows.iter().zip(&weights) {
            for &column in row {
                reduced[column as usize] -= weight;
            }
        }
        Direction { values, reduced, slack, weights }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_odd_cycle_of_pairs_is_half_covered() {
        // Vertex cover of a triangle: 1/2 each.
        let rows = [vec![0, 1], vec![1, 2], vec![0, 2]];
        let point = minimise_covering(&[1.0; 3], &rows, 1e-9, &mut Budget::new(None, None)).unwrap();
        assert!(point.gap <= 1e-9);
        assert!(point.values.iter().all(|value| (value - 0.5).abs() < 1e-6));
        assert!((point.weights.iter().sum::<f64>() - 1.5).abs() < 1e-8);
    }

    #[test]
    fn the_cheapest_variable_covers() {
        let rows = [vec![0, 1, 2], vec![1, 3]];
        let point =
            minimise_covering(&[1.0, 1.5, 1.0, 9.0], &rows, 1e-9, &mut Budget::new(None, None)).unwrap();
        assert!((point.values[1] - 1.0).abs() < 1e-6);
        assert!((point.weights.iter().sum::<f64>() - 1.5).abs() < 1e-8);
    }
}

//! A primal-dual interior point method for covering linear programs.

use super::clique_matrix::CliqueMatrix;
use crate::budget::Budget;

/// A point of the central path near the optimum.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    /// Feasible primal values.
    pub(crate) values: Vec<f64>,
    /// Feasible dual weights, one for each row.
    pub(crate) weights: Vec<f64>,
    /// Objective of `values` minus objective of `weights`.
    pub(crate) gap: f64,
}

/// Most Newton steps; 10 to 30 are usual.
const STEPS: usize = 100;

/// One covering inequality: the sum of coefficients times variables is at least `least`.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    /// Variables and positive coefficients; each variable occurs once.
    pub(crate) entries: Vec<(u32, f32)>,
    pub(crate) least: f64,
}

impl Row {
    pub(crate) fn value(&self, values: &[f64]) -> f64 {
        self.entries
            .iter()
            .map(|&(column, coefficient)| f64::from(coefficient) * values[column as usize])
            .sum()
    }
}

/// Largest share of the distance to the boundary that a step takes.
const DAMPING: f64 = 0.995;

/// Consecutive Newton steps without progress that are allowed.
const PATIENCE: usize = 8;

/// Minimises `costs * x` subject to `rows` and `x >= 0`, with positive costs, until the gap is at most `tolerance`. The dual
/// packs the rows into capacities `costs`. At `x = 1` every row must have slack.
///
/// Mehrotra's predictor-corrector method (SIAM J. Optimization 2(4), 1992) starts from a strictly feasible pair, so that
/// every iterate gives a valid bound. The Newton system is reduced to one unknown for each variable or for each row,
/// whichever is sparser. A sparse Cholesky factorisation solves it on one thread, so results do not depend on the number of
/// threads. Each row of a cycle program has one repulsive edge, so the variables of repulsive edges never share a row. With a
/// few long cycles, the system of rows is small. Returns `None` if the factorisation fails or memory is short.
pub(crate) fn minimise_covering(
    costs: &[f64],
    rows: &[Row],
    tolerance: f64,
    budget: &mut Budget,
) -> Option<Point> {
    let mut system = NewtonSystem::new(costs.len(), rows)?;
    // A strictly feasible start. At x = 1 every row has slack. Each row takes half of its share of its scarcest capacity, so
    // that at least half of every capacity remains.
    let mut values = vec![1.0; costs.len()];
    let mut load = vec![0.0; costs.len()];
    for &(column, coefficient) in rows.iter().flat_map(|row| &row.entries) {
        load[column as usize] += f64::from(coefficient);
    }
    let share = |column: u32| 0.5 * costs[column as usize] / load[column as usize];
    let mut weights: Vec<f64> = rows
        .iter()
        .map(|row| row.entries.iter().map(|entry| share(entry.0)).fold(f64::INFINITY, f64::min))
        .collect();
    let mut point = Point { gap: f64::INFINITY, values: values.clone(), weights: weights.clone() };
    let mut stalled = 0;
    for _ in 0..STEPS {
        let slack: Vec<f64> = rows.iter().map(|row| row.value(&values) - row.least).collect();
        let mut reduced = costs.to_vec();
        subtract_transposed(rows, &weights, &mut reduced);
        // Rounding can leave the interior, where the iterate is no bound. The best point so far still is one.
        if slack.iter().chain(&reduced).any(|value| *value <= 0.0) {
            break;
        }
        // Both sides are feasible, so by weak duality the optimum lies in this gap.
        let gap = dot(costs, &values)
            - rows.iter().zip(&weights).map(|(row, weight)| row.least * weight).sum::<f64>();
        if gap < point.gap {
            point = Point { gap, values: values.clone(), weights: weights.clone() };
            stalled = 0;
        } else {
            // The first step may lead back to the central path without progress.
            stalled += 1;
        }
        let work = system.work();
        if gap <= tolerance || stalled > PATIENCE || !budget.affords(work) || !budget.spend(work) {
            break;
        }
        // mu is the mean product of complementary pairs; on the central path all of these products equal mu.
        let count = (costs.len() + rows.len()) as f64;
        let mean = (dot(&slack, &weights) + dot(&reduced, &values)) / count;
        let state = State { values: &values, slack: &slack, weights: &weights, reduced: &reduced };
        if system.factorise(&state).is_none() {
            break;
        }
        // Predictor: the Newton step for products of zero, straight to the optimum (Nocedal, Wright 2006, algorithm 14.3).
        let affine = system.direction(&state, &|index| -weights[index] * slack[index], &|index| {
            -values[index] * reduced[index]
        });
        let (primal, dual) = affine.lengths(&state, 1.0);
        let ahead =
            (0..rows.len())
                .map(|i| (slack[i] + primal * affine.slack[i]) * (weights[i] + dual * affine.weights[i]))
                .chain((0..costs.len()).map(|j| {
                    (values[j] + primal * affine.values[j]) * (reduced[j] + dual * affine.reduced[j])
                }))
                .sum::<f64>()
                / count;
        // Mehrotra's centring is sigma mu with sigma = (mu_affine / mu)^3: nearly none where the predictor makes a long step.
        let centre = mean * (ahead / mean).powi(3);
        // Corrector: towards the centre, with the second-order term of the predictor.
        let step = system.direction(
            &state,
            &|i| centre - weights[i] * slack[i] - affine.slack[i] * affine.weights[i],
            &|j| centre - values[j] * reduced[j] - affine.values[j] * affine.reduced[j],
        );
        // Stop short of the boundary, because steps that start next to it are short. Primal and dual steps of different
        // lengths keep both feasible, since each starts feasible and its constraints are linear.
        let (primal, dual) = step.lengths(&state, DAMPING);
        for (value, change) in values.iter_mut().zip(&step.values) {
            *value += primal * change;
        }
        for (weight, change) in weights.iter_mut().zip(&step.weights) {
            *weight += dual * change;
        }
    }
    point.gap.is_finite().then_some(point)
}

/// Subtracts from each variable's entry of `target` the sum of coefficient times weight over the rows.
fn subtract_transposed(rows: &[Row], weights: &[f64], target: &mut [f64]) {
    for (row, &weight) in rows.iter().zip(weights) {
        for &(column, coefficient) in &row.entries {
            target[column as usize] -= f64::from(coefficient) * weight;
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

struct State<'a> {
    values: &'a [f64],
    slack: &'a [f64],
    weights: &'a [f64],
    reduced: &'a [f64],
}

struct Direction {
    values: Vec<f64>,
    reduced: Vec<f64>,
    slack: Vec<f64>,
    weights: Vec<f64>,
}

impl Direction {
    /// Longest primal and dual steps, at most 1, that go at most the share `damping` of the way to the boundary.
    fn lengths(&self, state: &State, damping: f64) -> (f64, f64) {
        let longest = |at: &[f64], change: &[f64]| {
            at.iter()
                .zip(change)
                .filter(|(_, change)| **change < 0.0)
                .map(|(at, change)| -damping * at / change)
                .fold(1.0, f64::min)
        };
        (
            longest(state.values, &self.values).min(longest(state.slack, &self.slack)),
            longest(state.reduced, &self.reduced).min(longest(state.weights, &self.weights)),
        )
    }
}

/// With rows `A`, variables `x`, reduced costs `r`, slacks `s` and weights `w`: `diag(r / x) + A' diag(w / s) A`, or
/// `diag(s / w) + A diag(x / r) A'`.
struct NewtonSystem<'a> {
    rows: &'a [Row],
    by_rows: bool,
    matrix: CliqueMatrix,
}

impl<'a> NewtonSystem<'a> {
    fn new(columns: usize, rows: &'a [Row]) -> Option<Self> {
        let mut transposed: Vec<Vec<(u32, f32)>> = vec![Vec::new(); columns];
        for (index, row) in rows.iter().enumerate() {
            for &(column, coefficient) in &row.entries {
                transposed[column as usize].push((index as u32, coefficient));
            }
        }
        let pairs =
            |lengths: &mut dyn Iterator<Item = usize>| lengths.map(|length| length * length).sum::<usize>();
        let over_columns = pairs(&mut rows.iter().map(|row| row.entries.len()));
        let over_rows = pairs(&mut transposed.iter().map(Vec::len));
        // The variables of repulsive edges never share a row, so the form in variables is sparser than this count suggests.
        let by_rows = 2 * over_rows < over_columns;
        let matrix = if by_rows {
            CliqueMatrix::new(rows.len(), transposed)?
        } else {
            CliqueMatrix::new(columns, rows.iter().map(|row| row.entries.clone()).collect())?
        };
        Some(Self { rows, by_rows, matrix })
    }

    fn work(&self) -> u64 {
        self.matrix.work()
    }

    fn factorise(&mut self, state: &State) -> Option<()> {
        let over = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a / b).collect() };
        let of_columns = over(state.reduced, state.values);
        let of_rows = over(state.slack, state.weights);
        let inverted = |ratios: Vec<f64>| -> Vec<f64> { ratios.iter().map(|ratio| 1.0 / ratio).collect() };
        if self.by_rows {
            self.matrix.factorise(&of_rows, &inverted(of_columns))
        } else {
            self.matrix.factorise(&of_columns, &inverted(of_rows))
        }
    }

    /// The Newton direction for the complementarity right-hand sides `t` of rows and columns: `s dw + w ds = t_rows`,
    /// `x dr + r dx = t_columns`. The eliminated unknowns follow from the constraints, so that iterates stay feasible even if the
    /// factorisation is inaccurate.
    fn direction(
        &mut self,
        state: &State,
        row_target: &dyn Fn(usize) -> f64,
        column_target: &dyn Fn(usize) -> f64,
    ) -> Direction {
        let rows = self.rows;
        let row_targets: Vec<f64> = (0..rows.len()).map(row_target).collect();
        let column_targets: Vec<f64> = (0..state.values.len()).map(column_target).collect();
        if self.by_rows {
            // (diag(s / w) + A diag(x / r) A') dw = t_rows / w - A (t_columns / r), from dx = (t_columns - x dr) / r, dr = -A' dw
            // and A dx = ds = (t_rows - s dw) / w.
            let alone: Vec<f64> =
                column_targets.iter().zip(state.reduced).map(|(target, reduced)| target / reduced).collect();
            let mut weights: Vec<f64> = (rows.iter().zip(&row_targets).zip(state.weights))
                .map(|((row, target), weight)| target / weight - row.value(&alone))
                .collect();
            self.matrix.solve(&mut weights);
            let mut reduced = vec![0.0; column_targets.len()];
            subtract_transposed(rows, &weights, &mut reduced);
            let values: Vec<f64> = (0..reduced.len())
                .map(|j| (column_targets[j] - state.values[j] * reduced[j]) / state.reduced[j])
                .collect();
            let slack = rows.iter().map(|row| row.value(&values)).collect();
            return Direction { values, reduced, slack, weights };
        }
        // (diag(r / x) + A' diag(w / s) A) dx = t_columns / x + A' (t_rows / s), from the same equations with dw eliminated.
        let mut values: Vec<f64> =
            column_targets.iter().zip(state.values).map(|(target, value)| target / value).collect();
        let pulls: Vec<f64> =
            row_targets.iter().zip(state.slack).map(|(target, slack)| -target / slack).collect();
        subtract_transposed(rows, &pulls, &mut values);
        self.matrix.solve(&mut values);
        let slack: Vec<f64> = rows.iter().map(|row| row.value(&values)).collect();
        let weights: Vec<f64> = (0..rows.len())
            .map(|i| (row_targets[i] - state.weights[i] * slack[i]) / state.slack[i])
            .collect();
        let mut reduced = vec![0.0; values.len()];
        subtract_transposed(rows, &weights, &mut reduced);
        Direction { values, reduced, slack, weights }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(lists: &[&[u32]]) -> Vec<Row> {
        let row =
            |list: &&[u32]| Row { entries: list.iter().map(|&column| (column, 1.0)).collect(), least: 1.0 };
        lists.iter().map(row).collect()
    }

    #[test]
    fn an_odd_cycle_of_pairs_is_half_covered() {
        // Vertex cover of a triangle: 1/2 each.
        let rows = rows(&[&[0, 1], &[1, 2], &[0, 2]]);
        let point = minimise_covering(&[1.0; 3], &rows, 1e-9, &mut Budget::new(None, None)).unwrap();
        assert!(point.gap <= 1e-9);
        assert!(point.values.iter().all(|value| (value - 0.5).abs() < 1e-6));
        assert!((point.weights.iter().sum::<f64>() - 1.5).abs() < 1e-8);
    }

    #[test]
    fn the_cheapest_variable_covers() {
        let rows = rows(&[&[0, 1, 2], &[1, 3]]);
        let point =
            minimise_covering(&[1.0, 1.5, 1.0, 9.0], &rows, 1e-9, &mut Budget::new(None, None)).unwrap();
        assert!((point.values[1] - 1.0).abs() < 1e-6);
        assert!((point.weights.iter().sum::<f64>() - 1.5).abs() < 1e-8);
    }

    #[test]
    fn both_forms_of_the_newton_system_agree() {
        // Three rows over ten variables are solved by rows; the same rows split over many by variables.
        let wide = rows(&[&[0, 1, 2, 3, 4], &[4, 5, 6, 7], &[7, 8, 9, 0]]);
        let costs: Vec<f64> = (0..10).map(|index| 1.0 + f64::from(index % 3)).collect();
        let mut answers = Vec::new();
        for by_rows in [true, false] {
            let mut system = NewtonSystem::new(10, &wide).unwrap();
            assert!(system.by_rows);
            if !by_rows {
                let cliques = wide.iter().map(|row| row.entries.clone()).collect();
                system =
                    NewtonSystem { rows: &wide, by_rows, matrix: CliqueMatrix::new(10, cliques).unwrap() };
            }
            let (values, weights) = (vec![0.7; 10], vec![0.2, 0.3, 0.1]);
            let slack: Vec<f64> = wide.iter().map(|row| row.value(&values) - 1.0).collect();
            let mut reduced = costs.clone();
            subtract_transposed(&wide, &weights, &mut reduced);
            let state = State { values: &values, slack: &slack, weights: &weights, reduced: &reduced };
            system.factorise(&state).unwrap();
            let Direction { values, weights, .. } =
                system.direction(&state, &|i| 0.1 * i as f64, &|j| 0.3 - 0.1 * j as f64);
            answers.push([values, weights].concat());
        }
        for (a, b) in answers[0].iter().zip(&answers[1]) {
            assert!((a - b).abs() < 1e-9, "{answers:?}");
        }
    }

    #[test]
    fn a_coefficient_of_two_counts_twice() {
        let row = |entries: &[(u32, f32)], least| Row { entries: entries.to_vec(), least };
        // 2 a + b >= 2 at costs 3 and 2: a = 1 is cheapest.
        let program = [row(&[(0, 2.0), (1, 1.0)], 2.0)];
        let point = minimise_covering(&[3.0, 2.0], &program, 1e-9, &mut Budget::new(None, None)).unwrap();
        assert!((point.values[0] - 1.0).abs() < 1e-6 && (point.weights[0] - 1.5).abs() < 1e-6);
    }
}

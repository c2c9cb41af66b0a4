//! The inverse of a small dense matrix, kept up to date as rows and columns come and go.

/// Entries below this value count as zero, so that updates skip them.
const NOTHING: f64 = 1e-14;

/// The inverse of a square matrix whose columns are basic variables and whose rows are tight inequalities. Row `a` of the
/// inverse belongs to variable `a`, and column `t` to inequality `t`.
#[derive(Debug, Clone, Default)]
pub(super) struct Inverse {
    size: usize,
    /// Distance between rows in `entries`, which leaves room to grow.
    stride: usize,
    entries: Vec<f64>,
}

impl Inverse {
    pub(super) fn size(&self) -> usize {
        self.size
    }

    pub(super) fn row(&self, variable: usize) -> &[f64] {
        &self.entries[variable * self.stride..variable * self.stride + self.size]
    }

    fn row_mut(&mut self, variable: usize) -> &mut [f64] {
        &mut self.entries[variable * self.stride..variable * self.stride + self.size]
    }

    /// The row vector `weights' M`, for weights of variables.
    pub(super) fn left(&self, weights: impl Iterator<Item = (usize, f64)>) -> Vec<f64> {
        let mut product = vec![0.0; self.size];
        for (variable, weight) in weights {
            for (sum, entry) in product.iter_mut().zip(self.row(variable)) {
                *sum += weight * entry;
            }
        }
        product
    }

    /// The column vector `M values`, for values of a few inequalities.
    pub(super) fn right(&self, values: &[(usize, f64)]) -> Vec<f64> {
        (0..self.size)
            .map(|variable| {
                let row = self.row(variable);
                values.iter().map(|&(place, value)| row[place] * value).sum()
            })
            .collect()
    }

    /// The column vector `M values`.
    pub(super) fn right_dense(&self, values: &[f64]) -> Vec<f64> {
        (0..self.size)
            .map(|variable| self.row(variable).iter().zip(values).map(|(a, b)| a * b).sum())
            .collect()
    }

    /// Subtracts `column row'` where neither is negligible.
    fn subtract(&mut self, column: &[f64], row: &[f64]) {
        let places: Vec<(usize, f64)> =
            row.iter().copied().enumerate().filter(|entry| entry.1.abs() > NOTHING).collect();
        let sparse = places.len() * 4 < row.len();
        for (variable, &factor) in column.iter().enumerate() {
            if factor.abs() <= NOTHING {
                continue;
            }
            let entries = &mut self.entries[variable * self.stride..variable * self.stride + self.size];
            if sparse {
                for &(place, value) in &places {
                    entries[place] -= factor * value;
                }
            } else {
                for (entry, value) in entries.iter_mut().zip(row) {
                    *entry -= factor * value;
                }
            }
        }
    }

    /// Adds a variable and an inequality at the ends. `column` is `M` times the variable's coefficients, `row` the
    /// inequality's coefficients times `M`, and `pivot` the inequality's coefficient of the variable minus `row` times the
    /// variable's coefficients.
    pub(super) fn grow(&mut self, column: &[f64], row: &[f64], pivot: f64) {
        let scaled: Vec<f64> = row.iter().map(|value| -value / pivot).collect();
        self.subtract(column, &scaled);
        if self.size == self.stride {
            let stride = (self.stride * 3 / 2).max(16);
            let mut entries = vec![0.0; stride * stride];
            for variable in 0..self.size {
                entries[variable * stride..variable * stride + self.size].copy_from_slice(self.row(variable));
            }
            (self.entries, self.stride) = (entries, stride);
        }
        let last = self.size;
        self.size += 1;
        for (variable, &value) in column.iter().enumerate() {
            self.row_mut(variable)[last] = -value / pivot;
        }
        let own = self.row_mut(last);
        own[..last].copy_from_slice(&scaled);
        own[last] = 1.0 / pivot;
    }

    /// Replaces the inequality at `place` by one whose coefficients times `M` are `row`.
    pub(super) fn replace_row(&mut self, place: usize, row: &[f64]) {
        let pivot = row[place];
        let mut change = row.to_vec();
        change[place] = pivot - 1.0;
        let column: Vec<f64> = (0..self.size).map(|variable| self.row(variable)[place] / pivot).collect();
        self.subtract(&column, &change);
    }

    /// Replaces the variable at `place` by one for which `M` times its coefficients is `column`.
    pub(super) fn replace_column(&mut self, place: usize, column: &[f64]) {
        let pivot = column[place];
        let row: Vec<f64> = self.row(place).iter().map(|value| value / pivot).collect();
        let mut change = column.to_vec();
        change[place] = pivot - 1.0;
        self.subtract(&change, &row);
    }

    /// Removes a variable and an inequality; the last ones take their places.
    pub(super) fn shrink(&mut self, variable: usize, place: usize) {
        let row = self.row(variable).to_vec();
        let pivot = row[place];
        let column: Vec<f64> = (0..self.size).map(|other| self.row(other)[place] / pivot).collect();
        self.subtract(&column, &row);
        let last = self.size - 1;
        if variable != last {
            let moved = self.row(last).to_vec();
            self.row_mut(variable).copy_from_slice(&moved);
        }
        for other in 0..last {
            let row = self.row_mut(other);
            row[place] = row[last];
        }
        self.size = last;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest entry of `M K - 1`.
    fn error(inverse: &Inverse, matrix: &[Vec<f64>]) -> f64 {
        let size = matrix.len();
        assert_eq!(inverse.size(), size);
        let mut worst = 0.0f64;
        for variable in 0..size {
            let product = |column: usize| -> f64 {
                inverse.row(variable).iter().zip(matrix).map(|(entry, row)| entry * row[column]).sum()
            };
            let unit = |column| f64::from(u8::from(variable == column));
            worst = (0..size).map(|column| (product(column) - unit(column)).abs()).fold(worst, f64::max);
        }
        worst
    }

    fn grow(inverse: &mut Inverse, matrix: &mut Vec<Vec<f64>>, column: &[f64], row: &[f64], corner: f64) {
        let left = inverse.left(row.iter().copied().enumerate());
        let right = inverse.right_dense(column);
        let pivot = corner - left.iter().zip(column).map(|(a, b)| a * b).sum::<f64>();
        inverse.grow(&right, &left, pivot);
        for (own, value) in matrix.iter_mut().zip(column) {
            own.push(*value);
        }
        matrix.push(row.iter().copied().chain([corner]).collect());
    }

    #[test]
    fn every_update_keeps_the_inverse() {
        let (mut inverse, mut matrix) = (Inverse::default(), Vec::new());
        let value = |seed: usize| ((seed * 7919 + 13) % 17) as f64 / 4.0 - 2.0;
        for size in 0..20 {
            let column: Vec<f64> = (0..size).map(|place| value(size * 31 + place)).collect();
            let row: Vec<f64> = (0..size).map(|place| value(size * 57 + 3 * place)).collect();
            grow(&mut inverse, &mut matrix, &column, &row, 5.0 + size as f64);
        }
        assert!(error(&inverse, &matrix) < 1e-9);
        let fresh: Vec<f64> = (0..20).map(|place| value(1000 + place) + 0.1).collect();
        let left = inverse.left(fresh.iter().copied().enumerate());
        inverse.replace_row(3, &left);
        matrix[3].clone_from(&fresh);
        assert!(error(&inverse, &matrix) < 1e-8);
        let right = inverse.right_dense(&fresh);
        inverse.replace_column(7, &right);
        for (row, value) in matrix.iter_mut().zip(&fresh) {
            row[7] = *value;
        }
        assert!(error(&inverse, &matrix) < 1e-8);
        inverse.shrink(2, 11);
        matrix.swap_remove(11);
        for row in &mut matrix {
            row.swap_remove(2);
        }
        assert!(error(&inverse, &matrix) < 1e-8);
    }
}

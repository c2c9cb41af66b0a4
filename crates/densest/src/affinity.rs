//! How well pairs of candidates agree: a sparse symmetric matrix.

use std::borrow::Cow;

use rayon::prelude::*;

/// The fewest rows of a task: with fewer, starting threads costs more than the sums.
const ROWS_PER_TASK: usize = 128;

/// Weights of consistent pairs; a pair without a weight is inconsistent. Every vertex has weight 1 with itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Affinity {
    /// For each vertex its neighbours, ascending, with their weights in (0, 1]. Single precision, because memory limits the
    /// products.
    rows: Vec<Vec<(u32, f32)>>,
}

impl Affinity {
    /// Computes the weights of all pairs of `count` vertices: `weight(a, b)` for `a < b`, `None` if they are inconsistent.
    /// Rows run in parallel; the result does not depend on the number of threads. N (N - 1) / 2 calls; 8 bytes for each
    /// consistent pair and direction.
    pub fn new(count: usize, weight: impl Fn(usize, usize) -> Option<f64> + Sync) -> Self {
        let upper: Vec<Vec<(u32, f32)>> = (0..count)
            .into_par_iter()
            .map(|row| {
                (row + 1..count)
                    .filter_map(|column| Some((column as u32, weight(row, column)? as f32)))
                    .collect()
            })
            .collect();
        let mut rows: Vec<Vec<(u32, f32)>> = vec![Vec::new(); count];
        // Goes by ascending row, so that every list is ascending: first the smaller neighbours, then the larger ones.
        for (row, pairs) in upper.into_iter().enumerate() {
            for &(column, weight) in &pairs {
                rows[column as usize].push((row as u32, weight));
            }
            rows[row].extend(pairs);
        }
        Self { rows }
    }

    /// Number of vertices.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no vertices.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Number of consistent pairs.
    pub fn pairs(&self) -> usize {
        self.rows.iter().map(Vec::len).sum::<usize>() / 2
    }

    /// The neighbours of a vertex, ascending, with their weights.
    pub fn neighbours(&self, vertex: usize) -> &[(u32, f32)] {
        &self.rows[vertex]
    }

    /// The weight of a pair; `None` if it is inconsistent. O(log neighbours).
    pub fn weight(&self, a: usize, b: usize) -> Option<f64> {
        let row = &self.rows[a];
        row.binary_search_by_key(&(b as u32), |&(column, _)| column).ok().map(|place| row[place].1.into())
    }

    /// The vertices that can be in a clique of `members`: each is consistent with enough others of them. O(pairs).
    pub(crate) fn core(&self, members: usize) -> Vec<usize> {
        let mut degrees: Vec<usize> = self.rows.iter().map(Vec::len).collect();
        let mut stays: Vec<bool> = degrees.iter().map(|degree| degree + 1 >= members).collect();
        let mut leaving: Vec<usize> = (0..self.len()).filter(|&vertex| !stays[vertex]).collect();
        while let Some(vertex) = leaving.pop() {
            for &(other, _) in &self.rows[vertex] {
                let other = other as usize;
                degrees[other] -= 1;
                if stays[other] && degrees[other] + 1 < members {
                    stays[other] = false;
                    leaving.push(other);
                }
            }
        }
        (0..self.len()).filter(|&vertex| stays[vertex]).collect()
    }

    /// The weights among some vertices (ascending), which are renumbered in their order. O(their pairs); free if they are
    /// all vertices.
    pub(crate) fn among(&self, vertices: &[usize]) -> Cow<'_, Self> {
        if vertices.len() == self.len() {
            return Cow::Borrowed(self);
        }
        let mut numbers = vec![u32::MAX; self.len()];
        for (number, &vertex) in vertices.iter().enumerate() {
            numbers[vertex] = number as u32;
        }
        let inside = |&(other, weight): &(u32, f32)| {
            let number = numbers[other as usize];
            (number != u32::MAX).then_some((number, weight))
        };
        let row = |&vertex: &usize| self.rows[vertex].iter().filter_map(inside).collect();
        Cow::Owned(Self { rows: vertices.iter().map(row).collect() })
    }

    /// M u, and for each vertex the sum of u over the vertices inconsistent with it. O(consistent pairs of the vertices
    /// above zero).
    pub(crate) fn products(&self, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let support = u.iter().filter(|component| **component != 0.0).count();
        if 2 * support < u.len() { self.products_by_column(u) } else { self.products_by_row(u) }
    }

    /// [`Self::products`] if most of `u` is zero: the same terms in the same order, without the zeros.
    fn products_by_column(&self, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let total: f64 = u.iter().sum();
        let (mut weighted, mut consistent) = (u.to_vec(), u.to_vec());
        for (row, &component) in self.rows.iter().zip(u) {
            if component == 0.0 {
                continue;
            }
            for &(other, weight) in row {
                weighted[other as usize] += f64::from(weight) * component;
                consistent[other as usize] += component;
            }
        }
        (weighted, consistent.into_iter().map(|consistent| (total - consistent).max(0.0)).collect())
    }

    fn products_by_row(&self, u: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let total: f64 = u.iter().sum();
        self.rows
            .par_iter()
            .with_min_len(ROWS_PER_TASK)
            .enumerate()
            .map(|(vertex, row)| {
                let (mut weighted, mut consistent) = (u[vertex], u[vertex]);
                for &(other, weight) in row {
                    weighted += f64::from(weight) * u[other as usize];
                    consistent += u[other as usize];
                }
                // Rounding may leave a value slightly below zero.
                (weighted, (total - consistent).max(0.0))
            })
            .unzip()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn products_by_column_are_those_by_row_to_the_bit(
            weights in proptest::collection::vec(proptest::option::of(0.01_f64..1.0), 400),
            u in proptest::collection::vec(prop_oneof![Just(0.0), 0.0_f64..1.0], 1..20),
        ) {
            let affinity = Affinity::new(u.len(), |a, b| weights[20 * a + b]);
            prop_assert_eq!(affinity.products_by_column(&u), affinity.products_by_row(&u));
        }
    }
}

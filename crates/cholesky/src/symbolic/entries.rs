//! Positions of the matrix's blocks in the fronts.

use super::Symbolic;
use super::front::Entry;
use crate::Adjacency;

impl Symbolic {
    /// Sorts the matrix's off-diagonal blocks by front.
    pub(super) fn place_entries(&mut self, pairs: &[(usize, usize)], position: &[usize]) {
        let column_of = |&(a, b): &(usize, usize)| position[a].min(position[b]);
        let by_front = Adjacency::new(
            self.fronts.len(),
            pairs.iter().enumerate().map(|(index, pair)| (self.front_of[column_of(pair)], index)),
        );
        self.entries.reserve(pairs.len());
        for index in 0..self.fronts.len() {
            let start = self.entries.len();
            for &pair in by_front.of(index) {
                let front = &self.fronts[index];
                let (a, b) = (position[pairs[pair].0], position[pairs[pair].1]);
                let row = a.max(b);
                let local_row = if row < front.first + front.columns {
                    row - front.first
                } else {
                    front.columns + self.rows[front.rows.clone()].partition_point(|&other| other < row)
                };
                let column = a.min(b) - front.first;
                self.entries.push(Entry { pair, column, row: local_row, transposed: a < b });
            }
            self.fronts[index].entries = start..self.entries.len();
        }
    }
}

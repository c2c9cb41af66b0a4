//! Parents and children of fronts, and the positions of a child's rows in its parent's front.

use super::Symbolic;
use crate::Adjacency;

impl Symbolic {
    /// Sets parents, lists of children, and the rows' positions in the parent's front.
    pub(super) fn link_parents(&mut self) {
        self.relative = vec![0; self.rows.len()];
        let mut arcs = Vec::new();
        for index in 0..self.fronts.len() {
            let rows = self.fronts[index].rows.clone();
            let Some(&first_row) = self.rows.get(rows.start).filter(|_| !rows.is_empty()) else { continue };
            let parent = self.front_of[first_row];
            self.fronts[index].parent = parent;
            arcs.push((parent, index));
            let target = &self.fronts[parent];
            let mut below = target.rows.clone();
            for place in rows {
                let row = self.rows[place];
                self.relative[place] = if row < target.first + target.columns {
                    row - target.first
                } else {
                    // Both lists ascend, so one walk finds every row.
                    while below.start < below.end && self.rows[below.start] < row {
                        below.start += 1;
                    }
                    target.columns + below.start - target.rows.start
                };
            }
        }
        let children = Adjacency::new(self.fronts.len(), arcs.iter().copied());
        for index in 0..self.fronts.len() {
            let start = self.children.len();
            self.children.extend_from_slice(children.of(index));
            self.fronts[index].children = start..self.children.len();
        }
    }
}

//! Supernodes: runs of columns of the factor with (almost) the same structure, eliminated together as one dense front.

use std::ops::Range;

use super::elimination::{ROOT, children};
use crate::Adjacency;

/// The supernodes of a factor in the order of their columns.
pub(crate) struct Supernodes {
    pub(crate) runs: Vec<Supernode>,
    /// The rows below each run, ascending. One piece of memory: a piece for each run would cost more than what is in it.
    pub(crate) rows: Vec<usize>,
}

/// A run of columns and the block rows below it.
pub(crate) struct Supernode {
    /// First column.
    pub(crate) first: usize,
    /// Number of columns.
    pub(crate) columns: usize,
    /// Where the rows below the last column are.
    pub(crate) rows: Range<usize>,
    /// Explicit zeros that amalgamation has put into the run's lower trapezoid.
    zeros: usize,
}

impl Supernode {
    fn height(&self) -> usize {
        self.columns + self.rows.len()
    }
}

/// Rows of each column of the factor below its diagonal, merged into maximal supernodes without extra zeros.
///
/// `upper` lists neighbours with larger positions; positions must be a postorder of the elimination tree `parent`.
pub(crate) fn maximal(parent: &[usize], upper: &Adjacency) -> Supernodes {
    let vertices = parent.len();
    let children = children(parent);
    let mut marked = vec![ROOT; vertices];
    // The structures of columns whose parents are still to come, one after the other. In postorder, those of a column's children are
    // the last ones.
    let mut waiting: Vec<usize> = Vec::new();
    let mut starts: Vec<usize> = vec![0; vertices];
    let mut rows: Vec<usize> = Vec::new();
    let mut before = 0;
    let mut runs: Vec<Supernode> = Vec::new();
    let mut below: Vec<usize> = Vec::new();
    for column in 0..vertices {
        // The structure of a column is the union of the matrix's rows and its children's rows, without the children
        // themselves: all further rows of a child are also rows of its parent.
        marked[column] = column;
        rows.clear();
        let start = children.of(column).first().map_or(waiting.len(), |&child| starts[child]);
        for &row in upper.of(column).iter().chain(&waiting[start..]) {
            if row > column && marked[row] != column {
                marked[row] = column;
                rows.push(row);
            }
        }
        waiting.truncate(start);
        waiting.extend_from_slice(&rows);
        starts[column] = start;
        // A column continues the previous column's run if it is its parent and has the same rows, except itself. The two
        // fronts are then one, without extra zeros.
        let continues = column > 0 && parent[column - 1] == column && before == rows.len() + 1;
        before = rows.len();
        let continued = runs.last_mut().filter(|_| continues);
        let start = continued.as_ref().map_or(below.len(), |last| last.rows.start);
        below.truncate(start);
        below.extend_from_slice(&rows);
        let end = below.len();
        match continued {
            Some(last) => {
                last.columns += 1;
                last.rows.end = end;
            }
            None => runs.push(Supernode { first: column, columns: 1, rows: start..end, zeros: 0 }),
        }
    }
    for run in &runs {
        below[run.rows.clone()].sort_unstable();
    }
    Supernodes { runs, rows: below }
}

/// Merges a supernode into its parent if the two are adjacent and this adds few zeros: larger fronts cost some arithmetic and
/// save much bookkeeping. The rule is CHOLMOD's (Chen, Davis, Hager, Rajamanickam, 2008); its limits, on numbers of scalar
/// columns, were set by measurement. `block` is the number of scalars in a block.
pub(crate) fn amalgamate(supernodes: Supernodes, block: usize) -> Supernodes {
    let Supernodes { runs, rows } = supernodes;
    // Right to left, so that a parent is complete before its last child asks to join it.
    let mut merged: Vec<Supernode> = Vec::with_capacity(runs.len());
    for child in runs.into_iter().rev() {
        match merged.last_mut() {
            Some(parent) if joins(&child, rows[child.rows.clone()].first(), parent, block) => {
                let new_zeros = child.columns * (child.columns + parent.height() - child.height());
                parent.first = child.first;
                parent.columns += child.columns;
                parent.zeros += child.zeros + new_zeros;
            }
            _ => merged.push(child),
        }
    }
    merged.reverse();
    Supernodes { runs: merged, rows }
}

/// Whether a supernode, with its first row, should join the one right after it.
fn joins(child: &Supernode, row: Option<&usize>, parent: &Supernode, block: usize) -> bool {
    let is_parent = row.is_some_and(|&row| row >= parent.first && row < parent.first + parent.columns);
    if !is_parent {
        return false;
    }
    let columns = child.columns + parent.columns;
    let zeros =
        child.zeros + parent.zeros + child.columns * (child.columns + parent.height() - child.height());
    let size = columns * (columns + 1) / 2 + columns * parent.rows.len();
    let share = zeros as f64 / size as f64;
    let scalars = columns * block;
    // In smaller fronts, bookkeeping takes a larger share of the time, so that more zeros are worth it.
    zeros == 0 || share < 0.1 || (scalars <= 64 && share < 0.2) || (scalars <= 24 && share < 0.5)
}

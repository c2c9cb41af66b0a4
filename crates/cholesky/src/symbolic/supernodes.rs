//! Supernodes: runs of columns of the factor with (almost) the same structure, eliminated together as one dense front.

use super::elimination::{ROOT, children};
use crate::Adjacency;

/// A run of columns and the block rows below it.
pub(crate) struct Supernode {
    /// First column.
    pub(crate) first: usize,
    /// Number of columns.
    pub(crate) columns: usize,
    /// Rows below the last column, ascending.
    pub(crate) rows: Vec<usize>,
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
pub(crate) fn maximal(parent: &[usize], upper: &Adjacency) -> Vec<Supernode> {
    let vertices = parent.len();
    let children = children(parent);
    let mut marked = vec![ROOT; vertices];
    let mut structure: Vec<Vec<usize>> = vec![Vec::new(); vertices];
    let mut supernodes: Vec<Supernode> = Vec::new();
    for column in 0..vertices {
        // The structure of a column is that of the matrix and of its children, less the children themselves: what a child has
        // further down, its parent has, too.
        marked[column] = column;
        let mut rows = Vec::new();
        let mut collect = |candidates: &[usize]| {
            for &row in candidates {
                if row > column && marked[row] != column {
                    marked[row] = column;
                    rows.push(row);
                }
            }
        };
        collect(upper.of(column));
        for &child in children.of(column) {
            collect(&structure[child]);
        }
        // A column goes on with the run of the last one if it is its parent and has the same rows but itself. Then the two fronts are
        // one, without a zero more.
        let continues =
            column > 0 && parent[column - 1] == column && structure[column - 1].len() == rows.len() + 1;
        // Nobody asks a child again: memory stays that of the tree's front line.
        for &child in children.of(column) {
            structure[child] = Vec::new();
        }
        structure[column].clone_from(&rows);
        match supernodes.last_mut() {
            Some(last) if continues => {
                last.columns += 1;
                last.rows = rows;
            }
            _ => supernodes.push(Supernode { first: column, columns: 1, rows, zeros: 0 }),
        }
    }
    for supernode in &mut supernodes {
        supernode.rows.sort_unstable();
    }
    supernodes
}

/// Merges a supernode into its parent where the two are adjacent and few zeros come of it: larger fronts cost some
/// arithmetic and save much bookkeeping. The rule is CHOLMOD's (Chen, Davis, Hager, Rajamanickam, 2008); its limits, on
/// numbers of scalar columns, were set by measurement. `block` is the number of scalars in a block.
pub(crate) fn amalgamate(supernodes: Vec<Supernode>, block: usize) -> Vec<Supernode> {
    // Right to left, so that a parent is complete before its last child asks to join it.
    let mut merged: Vec<Supernode> = Vec::with_capacity(supernodes.len());
    for child in supernodes.into_iter().rev() {
        match merged.last_mut() {
            Some(parent) if joins(&child, parent, block) => {
                let new_zeros = child.columns * (child.columns + parent.height() - child.height());
                parent.first = child.first;
                parent.columns += child.columns;
                parent.zeros += child.zeros + new_zeros;
            }
            _ => merged.push(child),
        }
    }
    merged.reverse();
    merged
}

/// Whether a supernode should join the one right after it.
fn joins(child: &Supernode, parent: &Supernode, block: usize) -> bool {
    let is_parent =
        child.rows.first().is_some_and(|&row| row >= parent.first && row < parent.first + parent.columns);
    if !is_parent {
        return false;
    }
    let columns = child.columns + parent.columns;
    let zeros =
        child.zeros + parent.zeros + child.columns * (child.columns + parent.height() - child.height());
    let size = columns * (columns + 1) / 2 + columns * parent.rows.len();
    let share = zeros as f64 / size as f64;
    let scalars = columns * block;
    // The smaller the front, the more of its time is bookkeeping, and the more zeros pay.
    zeros == 0 || share < 0.1 || (scalars <= 64 && share < 0.2) || (scalars <= 24 && share < 0.5)
}

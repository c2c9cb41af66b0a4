//! Approximate minimum degree.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

/// Approximate minimum degree (Amestoy, Davis and Duff, 1996) on the graph of blocks: `order[position] = variable`.
///
/// `pairs` are the off-diagonal blocks, each once, smaller variable first. If the ordering routine runs out of memory, the
/// order is that of the variables' numbers.
pub(crate) fn approximate_minimum_degree(variables: usize, pairs: &[(usize, usize)]) -> Vec<usize> {
    let identity = || (0..variables).collect();
    if pairs.is_empty() {
        return identity();
    }
    let (column_starts, rows) = upper_triangle(variables, pairs);
    let pattern =
        SymbolicSparseColMatRef::<usize>::new_checked(variables, variables, &column_starts, None, &rows);
    let mut order = vec![0_usize; variables];
    let mut position = vec![0_usize; variables];
    let Ok(mut memory) = MemBuffer::try_new(amd::order_scratch::<usize>(variables, rows.len())) else {
        return identity();
    };
    let stack = MemStack::new(&mut memory);
    match amd::order(&mut order, &mut position, pattern, amd::Control::default(), stack) {
        Ok(_) => order,
        Err(_) => identity(),
    }
}

/// The strict upper triangle in compressed columns with sorted rows.
fn upper_triangle(variables: usize, pairs: &[(usize, usize)]) -> (Vec<usize>, Vec<usize>) {
    let mut starts = vec![0_usize; variables + 1];
    for &(_, column) in pairs {
        starts[column + 1] += 1;
    }
    for column in 0..variables {
        starts[column + 1] += starts[column];
    }
    let mut next = starts.clone();
    let mut rows = vec![0_usize; pairs.len()];
    for &(row, column) in pairs {
        rows[next[column]] = row;
        next[column] += 1;
    }
    for column in 0..variables {
        rows[starts[column]..starts[column + 1]].sort_unstable();
    }
    (starts, rows)
}

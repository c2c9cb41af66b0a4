//! Approximate minimum degree.

use faer::Index;
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
    // Half the memory traffic where the numbers allow it; the order is the same.
    if variables.max(pairs.len()) < 1 << 28 {
        ordered::<u32>(variables, pairs).unwrap_or_else(identity)
    } else {
        ordered::<usize>(variables, pairs).unwrap_or_else(identity)
    }
}

/// The order with indices of this type; `None` if memory is short.
fn ordered<I: Index>(variables: usize, pairs: &[(usize, usize)]) -> Option<Vec<usize>> {
    let (column_starts, rows) = upper_triangle::<I>(variables, pairs);
    let pattern =
        SymbolicSparseColMatRef::<I>::new_checked(variables, variables, &column_starts, None, &rows);
    let mut order = vec![I::truncate(0); variables];
    let mut position = order.clone();
    let mut memory = MemBuffer::try_new(amd::order_scratch::<I>(variables, rows.len())).ok()?;
    let stack = MemStack::new(&mut memory);
    amd::order(&mut order, &mut position, pattern, amd::Control::default(), stack).ok()?;
    Some(order.iter().map(|&variable| variable.zx()).collect())
}

/// The strict upper triangle in compressed columns with sorted rows.
fn upper_triangle<I: Index>(variables: usize, pairs: &[(usize, usize)]) -> (Vec<I>, Vec<I>) {
    let mut starts = vec![0_usize; variables + 1];
    for &(_, column) in pairs {
        starts[column + 1] += 1;
    }
    for column in 0..variables {
        starts[column + 1] += starts[column];
    }
    let mut next = starts.clone();
    let mut rows = vec![I::truncate(0); pairs.len()];
    for &(row, column) in pairs {
        rows[next[column]] = I::truncate(row);
        next[column] += 1;
    }
    for column in 0..variables {
        rows[starts[column]..starts[column + 1]].sort_unstable();
    }
    (starts.into_iter().map(I::truncate).collect(), rows)
}

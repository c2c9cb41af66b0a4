//! Subtrees of the elimination tree that threads factorise in parallel.

use std::ops::Range;

use super::front::{Front, NO_PARENT};

/// Number of operations from which threads are worth their cost: each stretch needs stacks of its own, which cost memory.
const WORTH_THREADS: f64 = 1e8;
/// Largest share of all operations in one subtree; larger subtrees are divided. Ten or more pieces keep some threads busy
/// whatever their sizes. With many more pieces, the top, which one thread eliminates, would become larger.
const LARGEST_SHARE: f64 = 0.1;

/// Independent stretches of fronts, each made of whole subtrees. The rest, the top of the tree, comes after all of them.
///
/// There are none for a single thread, which reuses the memory of one subtree for the next. The numbers in a front are the
/// same in both cases. `work` holds the operations of each front; fronts are in postorder. O(fronts).
pub(super) fn independent(fronts: &[Front], work: &[f64]) -> Vec<Range<usize>> {
    let total: f64 = work.iter().sum();
    if total < WORTH_THREADS || rayon::current_num_threads() < 2 {
        return Vec::new();
    }
    let mut sums = work.to_vec();
    let mut first: Vec<usize> = (0..fronts.len()).collect();
    for (index, front) in fronts.iter().enumerate() {
        if front.parent != NO_PARENT {
            sums[front.parent] += sums[index];
            first[front.parent] = first[front.parent].min(first[index]);
        }
    }
    let largest = LARGEST_SHARE * total;
    let is_top = |index: usize| sums[index] > largest;
    let mut stretches: Vec<(Range<usize>, f64)> = Vec::new();
    for (index, front) in fronts.iter().enumerate() {
        if is_top(index) || !(front.parent == NO_PARENT || is_top(front.parent)) {
            continue;
        }
        match stretches.last_mut() {
            Some((range, sum)) if range.end == first[index] && *sum + sums[index] <= largest => {
                range.end = index + 1;
                *sum += sums[index];
            }
            _ => stretches.push((first[index]..index + 1, sums[index])),
        }
    }
    stretches.into_iter().map(|(range, _)| range).collect()
}

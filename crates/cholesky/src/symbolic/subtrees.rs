//! Subtrees of the elimination tree, which threads factorise and solve in parallel.

use std::ops::Range;

use super::Symbolic;
use super::front::{Front, NO_PARENT};

/// Number of operations from which threads are worth their cost: each stretch needs stacks of its own, which cost memory.
const WORTH_THREADS: f64 = 1e8;
/// Largest share of all operations in one subtree; larger subtrees are divided. Ten or more pieces keep some threads busy
/// whatever their sizes. With many more pieces, the top, which one thread eliminates, would become larger.
const LARGEST_SHARE: f64 = 0.1;

/// Fronts of one or more whole subtrees that stand side by side.
#[derive(Debug)]
pub(crate) struct Subtree {
    /// Children before parents.
    pub(crate) fronts: Vec<usize>,
    /// The positions of their columns in elimination order.
    pub(crate) positions: Range<usize>,
    /// Number of positions of this and all earlier subtrees.
    covered: usize,
}

impl Symbolic {
    /// Notes the subtrees, and the fronts above them.
    pub(super) fn divide(&mut self, ranges: &[Range<usize>]) {
        let mut covered = 0;
        let mut is_top = vec![true; self.fronts.len()];
        for range in ranges {
            is_top[range.clone()].fill(false);
            let (first, last) = (&self.fronts[range.start], &self.fronts[range.end - 1]);
            let positions = first.first..last.first + last.columns;
            covered += positions.len();
            self.subtrees.push(Subtree { fronts: range.clone().collect(), positions, covered });
        }
        self.top = (0..self.fronts.len()).filter(|&front| is_top[front]).collect();
    }

    /// Number of variables above all subtrees.
    pub(crate) fn top_variables(&self) -> usize {
        self.order.len() - self.subtrees.last().map_or(0, |last| last.covered)
    }

    /// The number of a position above the subtrees among all those above them. O(log subtrees).
    #[inline]
    pub(crate) fn top_index(&self, position: usize) -> usize {
        let before = self.subtrees.partition_point(|subtree| subtree.positions.end <= position);
        position - before.checked_sub(1).map_or(0, |last| self.subtrees[last].covered)
    }
}

/// Independent ranges of fronts, each made of whole subtrees. The rest, the top of the tree, comes after all of them.
///
/// The number of threads does not matter. `work` holds the operations of each front; fronts are in postorder. O(fronts).
pub(super) fn independent(fronts: &[Front], work: &[f64]) -> Vec<Range<usize>> {
    let total: f64 = work.iter().sum();
    if total < WORTH_THREADS {
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

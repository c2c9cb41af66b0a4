//! Adding a child's update matrix to its parent's front.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use super::view::FrontView;

/// A run of a child's rows that are contiguous in the parent's front, too. In scalars.
///
/// A child's rows mostly form a few runs, and adding a run needs no index per entry.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    source: usize,
    target: usize,
    length: usize,
}

/// Appends `length` rows of the child from `source` on, which are at `target` in the parent's front; both ascend.
#[inline(always)]
pub fn push_rows(runs: &mut Vec<Run>, source: usize, target: usize, length: usize) {
    match runs.last_mut() {
        Some(run) if run.target + run.length == target => run.length += length,
        _ => runs.push(Run { source, target, length }),
    }
}

/// Number of the child's rows among the front's first `columns`; these rows come first.
#[inline(always)]
pub(crate) fn rows_before(runs: &[Run], columns: usize) -> usize {
    runs.iter().map(|run| columns.saturating_sub(run.target).min(run.length)).sum()
}

/// Adds these columns of the lower triangle of a child's update matrix of that order, column-major, to the parent's front.
/// `runs` gives the positions of all rows of the child.
#[inline(always)]
pub fn extend_add(
    child: &[f64],
    order: usize,
    sources: std::ops::Range<usize>,
    runs: &[Run],
    front: FrontView<'_>,
) {
    let below = front.below();
    let FrontView { panel, height, columns, update, .. } = front;
    let mut first = 0;
    for source in sources {
        while runs[first].source + runs[first].length <= source {
            first += 1;
        }
        let column = runs[first].target + source - runs[first].source;
        let values = &child[source * order..][..order];
        let (target, skipped) = if column < columns {
            (&mut panel[column * height..][..height], 0)
        } else {
            (&mut update[(column - columns) * below..][..below], columns)
        };
        for run in &runs[first..] {
            // The first run may begin above the diagonal.
            let above = source.saturating_sub(run.source);
            let values = &values[run.source + above..run.source + run.length];
            let sums = &mut target[run.target + above - skipped..][..values.len()];
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value;
            }
        }
    }
}

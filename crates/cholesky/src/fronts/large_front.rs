//! Partial Cholesky factorisation of one large dense front, by blocks of columns.
//!
//! In the largest fronts, threads take strips of a block's rows, and strips of columns of the products. Every number is the same sum in the
//! same order, whatever the strips.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::ops::Range;

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::dense::{Scratch, eliminate_columns};
use super::product::{self, Rows, Target};
use super::view::FrontView;
use crate::instructions::for_small_blocks;

/// Columns that are eliminated before the rest is updated, at most. Fewer need more passes over the rest; more take longer, since
/// products of copied panels are twice as fast as those of columns.
const BLOCK: usize = 72;

/// Rows of a block that a thread eliminates at a time, beside the diagonal block. With [`BLOCK`] columns they fit a second-level cache.
const STRIP: usize = 384;

/// As `dense::eliminate_small`, up to rounding. `threads` is whether all threads share the work: the result is the same to the bit.
#[inline(always)]
pub(super) fn eliminate<const D: usize>(
    front: FrontView<'_>,
    memory: &mut Scratch,
    threads: bool,
) -> Result<(), usize> {
    // A block ends with a variable.
    let width = const { BLOCK / D * D };
    let below = front.below();
    let FrontView { panel, height, columns, update, fresh } = front;
    let Scratch { panels, strips } = memory;
    for first in (0..columns).step_by(width) {
        let end = columns.min(first + width);
        if threads {
            let block = &mut panel[first * height..end * height];
            eliminate_by_strips::<D>(block, height, first, strips).map_err(|column| first + column)?;
        } else {
            eliminate_columns::<D>(panel, height, first..end)?;
        }
        let (done, later) = panel.split_at_mut(end * height);
        let rows = Rows { values: &done[first * height..], height, first: end };
        let mut target = Target { values: later, height, first: end, fresh: false };
        product::subtract(&mut target, rows, panels, threads);
    }
    let mut target = Target { values: update, height: below, first: 0, fresh };
    product::subtract(&mut target, Rows { values: panel, height, first: columns }, panels, threads);
    Ok(())
}

/// Eliminates all columns of `block`, whose diagonal begins in row `first`. On failure returns the column.
///
/// Every strip is copied below the diagonal block, which is eliminated again for each: a tenth more arithmetic, and no strip waits.
fn eliminate_by_strips<const D: usize>(
    block: &mut [f64],
    height: usize,
    first: usize,
    memory: &mut Vec<f64>,
) -> Result<(), usize> {
    let width = block.len() / height;
    let below = first + width;
    let count = (height - below).div_ceil(STRIP).max(1);
    let size = (width + STRIP) * width;
    if memory.len() < count * size {
        memory.resize(count * size, 0.0);
    }
    let rows = |strip: usize| below + strip * STRIP..height.min(below + (strip + 1) * STRIP);
    let source = &*block;
    memory.par_chunks_mut(size).take(count).enumerate().try_for_each(|(index, strip)| {
        for_small_blocks(Strip::<D> {
            source,
            height,
            diagonal: first..below,
            rows: rows(index),
            target: strip,
        })
    })?;
    let memory = &*memory;
    block.par_chunks_exact_mut(height).enumerate().for_each(|(column, values)| {
        for (index, strip) in memory.chunks_exact(size).take(count).enumerate() {
            let rows = rows(index);
            let (diagonal, strip) = strip[column * (width + rows.len())..].split_at(width);
            if index == 0 {
                values[first..below].copy_from_slice(diagonal);
            }
            let count = rows.len();
            values[rows].copy_from_slice(&strip[..count]);
        }
    });
    Ok(())
}

/// Copies the diagonal block and some rows, and eliminates them. Not a closure: a closure would not be inlined.
struct Strip<'a, const D: usize> {
    source: &'a [f64],
    height: usize,
    diagonal: Range<usize>,
    rows: Range<usize>,
    target: &'a mut [f64],
}

impl<const D: usize> WithSimd for Strip<'_, D> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { source, height, diagonal, rows, target } = self;
        let width = diagonal.len();
        let target_height = width + rows.len();
        let target = &mut target[..width * target_height];
        for (target, source) in target.chunks_exact_mut(target_height).zip(source.chunks_exact(height)) {
            let (top, bottom) = target.split_at_mut(width);
            top.copy_from_slice(&source[diagonal.clone()]);
            bottom.copy_from_slice(&source[rows.clone()]);
        }
        eliminate_columns::<D>(target, target_height, 0..width)
    }
}

#[cfg(test)]
mod tests {
    use super::super::dense::eliminate_small;
    use super::*;

    /// The columns of a front, dominated by their diagonal, and an update matrix.
    fn front_of(height: usize, columns: usize) -> (Vec<f64>, Vec<f64>) {
        let entry = |row: usize, column: usize| ((row * 37 + column * 101 + row * column) as f64 * 0.7).sin();
        let mut panel = vec![0.0; height * columns];
        for column in 0..columns {
            for row in column..height {
                panel[column * height + row] = entry(row, column) + if row == column { 400.0 } else { 0.0 };
            }
        }
        let below = height - columns;
        (panel, (0..below * below).map(|index| (index as f64 * 0.3).cos()).collect())
    }

    /// What elimination makes of the columns and of the update matrix. Values above the diagonal mean nothing.
    fn eliminated(
        (height, columns): (usize, usize),
        fresh: bool,
        eliminate: impl FnOnce(FrontView<'_>) -> Result<(), usize> + Send,
        threads: usize,
    ) -> Vec<f64> {
        let (mut panel, mut update) = front_of(height, columns);
        let front = FrontView { panel: &mut panel, height, columns, update: &mut update, fresh };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| eliminate(front)).expect("the matrix is dominated by its diagonal");
        let lower = |matrix: &[f64], order: usize| -> Vec<f64> {
            let columns = matrix.chunks(order.max(1)).enumerate();
            columns.flat_map(|(column, values)| values[column..].to_vec()).collect()
        };
        [lower(&panel, height), lower(&update, height - columns)].concat()
    }

    /// With and without a right-hand side as the last column, with one block and several, one strip and several.
    fn blocks_and_strips_give_what_one_piece_does<const D: usize>() {
        let block = BLOCK / D * D;
        let sizes = [
            (block, block),
            (block + 7, D),
            (block + 30, block + D),
            (3 * block + 1, 2 * block),
            (block + 2 * STRIP + 30, block + D),
            (531, 300 / D * D),
        ];
        for size in sizes {
            for fresh in [false, true] {
                let expected = eliminated(size, fresh, eliminate_small::<D>, 1);
                let large = |threads: bool| {
                    move |front: FrontView<'_>| eliminate::<D>(front, &mut Scratch::default(), threads)
                };
                let found = eliminated(size, fresh, large(false), 1);
                let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(found.len() == expected.len() && apart < 1e-11, "{D} {size:?} {fresh}: {apart}");
                for threads in 1..=3 {
                    let by_strips = eliminated(size, fresh, large(true), threads);
                    assert!(by_strips == found, "{D} {size:?} {fresh}: {threads} threads");
                }
            }
        }
    }

    #[test]
    fn blocks_and_strips_agree_for_poses() {
        blocks_and_strips_give_what_one_piece_does::<3>();
        blocks_and_strips_give_what_one_piece_does::<6>();
    }

    /// Blocks of 72 columns once ended within a variable of the lifted problem, which has 14.
    #[test]
    fn blocks_and_strips_agree_where_the_columns_of_a_variable_do_not_divide_a_block() {
        blocks_and_strips_give_what_one_piece_does::<14>();
    }

    #[test]
    fn the_first_pivot_that_is_not_positive_is_named() {
        let (height, columns) = (531, 300);
        let (panel, mut update) = front_of(height, columns);
        for column in [BLOCK + 5, 200] {
            let mut panel = panel.clone();
            panel[column * height + column] = -1e6;
            let mut front =
                FrontView { panel: &mut panel, height, columns, update: &mut update, fresh: true };
            let before = front.panel.to_vec();
            assert_eq!(eliminate_small::<6>(front.reborrow()), Err(column));
            for threads in [false, true] {
                front.panel.copy_from_slice(&before);
                assert_eq!(eliminate::<6>(front.reborrow(), &mut Scratch::default(), threads), Err(column));
            }
        }
    }
}

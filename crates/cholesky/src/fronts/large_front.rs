//! Partial Cholesky factorisation of one very large dense front, by all threads.
//!
//! By blocks of columns, as that of any large front. Threads take strips of a block's rows, and strips of columns of the products. The strips
//! have fixed sizes, so every number is the same sum in the same order at any number of threads.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::ops::Range;

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::dense::{BLOCK, Scratch, eliminate_columns};
use super::product::{self, Rows, Target};
use super::view::FrontView;
use crate::instructions::for_small_blocks;

/// Rows of a block that a thread eliminates at a time, beside the diagonal block. With [`BLOCK`] columns they fit a second-level cache.
const STRIP: usize = 384;

/// As `dense::eliminate`, up to rounding.
pub(super) fn eliminate<const D: usize>(front: FrontView<'_>, memory: &mut Scratch) -> Result<(), usize> {
    let below = front.below();
    let FrontView { panel, height, columns, update, fresh } = front;
    let Scratch { panels, strips } = memory;
    for first in (0..columns).step_by(BLOCK) {
        let end = columns.min(first + BLOCK);
        let (done, later) = panel.split_at_mut(end * height);
        let block = &mut done[first * height..];
        eliminate_by_strips::<D>(block, height, first, strips).map_err(|column| first + column)?;
        let mut target = Target { values: later, height, first: end, fresh: false };
        product::subtract(&mut target, Rows { values: block, height, first: end }, panels, true);
    }
    let mut target = Target { values: update, height: below, first: 0, fresh };
    product::subtract(&mut target, Rows { values: panel, height, first: columns }, panels, true);
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
    use super::super::dense;
    use super::*;

    /// Eliminates the front of a matrix `B B^T + c I` by both methods.
    #[test]
    fn strips_give_what_one_piece_does_and_the_same_bits_on_any_number_of_threads() {
        let (height, columns) = (531, 300);
        let entry = |row: usize, column: usize| ((row * 37 + column * 101 + row * column) as f64 * 0.7).sin();
        let mut panel = vec![0.0; height * columns];
        for column in 0..columns {
            for row in column..height {
                panel[column * height + row] = entry(row, column) + if row == column { 400.0 } else { 0.0 };
            }
        }
        let below = height - columns;
        let start: Vec<f64> = (0..below * below).map(|index| (index as f64 * 0.3).cos()).collect();
        let solve = |threads: usize, fresh: bool| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            let (mut panel, mut update) = (panel.clone(), start.clone());
            let mut memory = Scratch::default();
            let front = FrontView { panel: &mut panel, height, columns, update: &mut update, fresh };
            pool.install(|| eliminate::<3>(front, &mut memory))
                .expect("the matrix is dominated by its diagonal");
            (panel, update)
        };
        for fresh in [false, true] {
            let (mut expected, mut update) = (panel.clone(), start.clone());
            let mut memory = Scratch::default();
            let front = FrontView { panel: &mut expected, height, columns, update: &mut update, fresh };
            dense::eliminate_by_blocks::<3>(front, true, &mut memory.panels)
                .expect("the matrix is dominated by its diagonal");
            let (found, found_update) = solve(1, fresh);
            let lower = |matrix: &[f64], order: usize, columns: usize| -> Vec<f64> {
                (0..columns)
                    .flat_map(|column| matrix[column * order + column..(column + 1) * order].to_vec())
                    .collect()
            };
            let apart =
                |a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart(lower(&expected, height, columns), lower(&found, height, columns)) < 1e-11);
            assert!(apart(lower(&update, below, below), lower(&found_update, below, below)) < 1e-11);
            assert_eq!(solve(2, fresh), solve(1, fresh));
            assert_eq!(solve(3, fresh), solve(1, fresh));
        }
        let mut indefinite = panel.clone();
        indefinite[200 * height + 200] = -1e6;
        let mut memory = Scratch::default();
        let front =
            FrontView { panel: &mut indefinite, height, columns, update: &mut start.clone(), fresh: true };
        let outcome = eliminate::<3>(front, &mut memory);
        assert_eq!(outcome, Err(200));
    }
}

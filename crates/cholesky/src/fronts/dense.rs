//! Partial Cholesky factorisation of one dense front.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::ops::Range;

use super::large_front;
use super::product::{self, Rows, Target};
use super::stored::Stored;
use super::view::FrontView;

/// From this number of operations on, copying operands of products to panels is worth that.
const LARGE_FRONT: usize = 100_000;

/// Columns of a large front that are eliminated before the rest is updated. Fewer need more passes over the rest; more take longer, since
/// products of copied panels are twice as fast as those of columns. A multiple of every order of a variable.
pub(super) const BLOCK: usize = 72;

/// From this number of operations on, a front is divided among threads. Only the front decides, not the number of threads,
/// since the two methods round differently.
const LARGEST_FRONT: usize = 40_000_000;

/// Working memory of the dense kernels.
#[derive(Debug, Default)]
pub struct Scratch {
    pub(super) panels: Vec<f64>,
    pub(super) strips: Vec<f64>,
}

impl Scratch {
    /// Reserves memory for the panels of products.
    pub(super) fn with_panels(size: usize) -> Self {
        // Pages that the system has zeroed, and that nothing touches before the first product.
        Self { panels: vec![0.0; size], ..Self::default() }
    }
}

/// How much memory for panels elimination of a front takes: none for a small one.
pub(super) fn panel_size(height: usize, columns: usize) -> usize {
    if operations(columns, height - columns) < LARGE_FRONT { 0 } else { product::panel_size(height, columns) }
}

fn operations(columns: usize, below: usize) -> usize {
    columns * (columns * columns / 3 + columns * below + below * below)
}

/// Eliminates the columns of a front. On failure returns the column whose pivot was not positive.
#[inline(always)]
pub fn eliminate<const D: usize>(front: FrontView<'_>, memory: &mut Scratch) -> Result<(), usize> {
    let operations = operations(front.columns, front.below());
    if operations < LARGEST_FRONT {
        eliminate_by_blocks::<D>(front, operations >= LARGE_FRONT, &mut memory.panels)
    } else {
        large_front::eliminate::<D>(front, memory)
    }
}

/// Eliminates the columns of a front left-looking. In a large front, [`BLOCK`] columns are eliminated like that, then subtracted from all
/// later ones.
///
/// Left-looking loads and stores columns once. Right-looking would rewrite all later columns every time, and memory accesses, not
/// arithmetic, limit the speed of small fronts.
#[inline(always)]
pub(super) fn eliminate_by_blocks<const D: usize>(
    front: FrontView<'_>,
    large: bool,
    panels: &mut Vec<f64>,
) -> Result<(), usize> {
    let below = front.below();
    let FrontView { panel, height, columns, update, fresh } = front;
    let width = if large { BLOCK } else { columns };
    for first in (0..columns).step_by(width.max(1)) {
        let end = columns.min(first + width);
        eliminate_columns::<D>(panel, height, first..end)?;
        if end < columns {
            let (done, later) = panel.split_at_mut(end * height);
            let rows = Rows { values: &done[first * height..], height, first: end };
            let mut target = Target { values: later, height, first: end, fresh: false };
            product::subtract(&mut target, rows, panels, false);
        }
    }
    if large {
        let mut target = Target { values: update, height: below, first: 0, fresh };
        product::subtract(&mut target, Rows { values: panel, height, first: columns }, panels, false);
        return Ok(());
    }
    if fresh {
        update.fill(0.0);
    }
    let mut column = 0;
    // The last column may be no whole block: an incremental front's right-hand side.
    while column < below {
        let target = &mut update[column * below..];
        if column + D <= below {
            subtract_products::<D>(target, below, column, panel, height, columns + column);
            column += D;
        } else {
            subtract_products::<1>(target, below, column, panel, height, columns + column);
            column += 1;
        }
    }
    Ok(())
}

/// Eliminates some columns, from which all earlier ones have been subtracted, left-looking by `D` columns.
#[inline(always)]
pub(super) fn eliminate_columns<const D: usize>(
    panel: &mut [f64],
    height: usize,
    columns: Range<usize>,
) -> Result<(), usize> {
    let first = columns.start;
    for start in columns.step_by(D) {
        let (done, later) = panel.split_at_mut(start * height);
        let block = &mut later[..D * height];
        subtract_products::<D>(block, height, start, &done[first * height..], height, start);
        factor_block::<D>(block, height, start)?;
    }
    Ok(())
}

/// Cholesky of `D` columns whose diagonal block starts at row `start`.
#[inline(always)]
fn factor_block<const D: usize>(block: &mut [f64], height: usize, start: usize) -> Result<(), usize> {
    for column in 0..D {
        let (done, later) = block.split_at_mut((column + 1) * height);
        let current = &mut done[column * height + start + column..];
        let pivot = current[0];
        // Not `pivot <= 0.0`: NaN must fail too.
        if !(pivot > 0.0 && pivot.is_finite()) {
            return Err(start + column);
        }
        let scale = 1.0 / pivot.sqrt();
        // One division per column; the product has one more rounding error than a quotient.
        for value in current.iter_mut() {
            *value *= scale;
        }
        for (offset, target) in later.chunks_exact_mut(height).enumerate().take(D - column - 1) {
            let factor = current[offset + 1];
            for (value, source) in
                target[start + column + 1 + offset..].iter_mut().zip(&current[offset + 1..])
            {
                *value -= factor * source;
            }
        }
    }
    Ok(())
}

/// `target[first + i, j] -= sum over columns k of source[row + i, k] source[row + j, k]` for `D` columns `j` of the target
/// and all rows of the source from `row` on. Values above the diagonal are undefined.
#[inline(always)]
fn subtract_products<const D: usize>(
    target: &mut [f64],
    stride: usize,
    first: usize,
    source: &[f64],
    height: usize,
    row: usize,
) {
    // A tile of a few vector registers stays in them over all columns of the source: six columns of eight rows take twelve of
    // the sixteen registers of AVX2. Larger tiles would spill.
    let length = height - row;
    let mut start = 0;
    while start + 8 <= length {
        subtract_tile::<D, 8>(target, stride, first, source, height, row, start);
        start += 8;
    }
    if start + 4 <= length {
        subtract_tile::<D, 4>(target, stride, first, source, height, row, start);
        start += 4;
    }
    if start + 2 <= length {
        subtract_tile::<D, 2>(target, stride, first, source, height, row, start);
        start += 2;
    }
    if start < length {
        subtract_tile::<D, 1>(target, stride, first, source, height, row, start);
    }
}

/// `W` rows of [`subtract_products`], from the one at `start`.
#[inline(always)]
fn subtract_tile<const D: usize, const W: usize>(
    target: &mut [f64],
    stride: usize,
    first: usize,
    source: &[f64],
    height: usize,
    row: usize,
    start: usize,
) {
    let mut sums = [[0.0_f64; W]; D];
    for (index, sums) in sums.iter_mut().enumerate() {
        sums.copy_from_slice(&target[index * stride + first + start..][..W]);
    }
    for column in source.chunks_exact(height) {
        let column = &column[row..];
        let (Some(factors), Some(values)) = (column.first_chunk::<D>(), column[start..].first_chunk::<W>())
        else {
            return;
        };
        for (sums, factor) in sums.iter_mut().zip(factors) {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum = factor.mul_add(-value, *sum);
            }
        }
    }
    for (index, sums) in sums.iter().enumerate() {
        target[index * stride + first + start..][..W].copy_from_slice(sums);
    }
}

/// `target -= sum over c of factors[c] sources[c]`; all are of one length.
#[inline(always)]
pub(super) fn subtract_columns<const D: usize, S: Stored>(
    target: &mut [f64],
    sources: &[&[S]; D],
    factors: &[f64; D],
) {
    let (tiles, rest) = target.as_chunks_mut::<8>();
    for (index, target) in tiles.iter_mut().enumerate() {
        subtract_chunk(target, sources, factors, 8 * index);
    }
    let start = 8 * tiles.len();
    for (index, target) in rest.iter_mut().enumerate() {
        for (source, factor) in sources.iter().zip(factors) {
            *target = factor.mul_add(-source[start + index].widened(), *target);
        }
    }
}

/// `W` rows of [`subtract_columns`].
#[inline(always)]
fn subtract_chunk<const D: usize, const W: usize, S: Stored>(
    target: &mut [f64; W],
    sources: &[&[S]; D],
    factors: &[f64; D],
    start: usize,
) {
    let mut sums = *target;
    for (source, factor) in sources.iter().zip(factors) {
        let Some(source) = source[start..].first_chunk::<W>() else { return };
        for (sum, value) in sums.iter_mut().zip(source) {
            *sum = factor.mul_add(-value.widened(), *sum);
        }
    }
    *target = sums;
}

/// The product of every column with a vector, in `W` partial sums each: a single sum would wait for its own last addition.
#[inline(always)]
pub fn products<const D: usize, const W: usize, S: Stored>(columns: &[&[S]; D], vector: &[f64]) -> [f64; D] {
    let mut sums = [[0.0_f64; W]; D];
    let whole = vector.len() - vector.len() % W;
    for start in (0..whole).step_by(W) {
        let Some(values) = vector[start..].first_chunk::<W>() else { break };
        for (sums, column) in sums.iter_mut().zip(columns) {
            let Some(entries) = column[start..].first_chunk::<W>() else { break };
            for ((sum, entry), value) in sums.iter_mut().zip(entries).zip(values) {
                *sum = entry.widened().mul_add(*value, *sum);
            }
        }
    }
    std::array::from_fn(|index| {
        let rest = columns[index][whole..].iter().zip(&vector[whole..]);
        sums[index].iter().sum::<f64>() + rest.map(|(entry, value)| entry.widened() * value).sum::<f64>()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With and without a right-hand side as the last column, with columns of one block and of several.
    #[test]
    fn blocks_give_what_one_piece_does() {
        for (height, columns) in
            [(BLOCK, BLOCK), (BLOCK + 7, 6), (BLOCK + 30, BLOCK + 6), (3 * BLOCK + 1, 2 * BLOCK)]
        {
            let below = height - columns;
            let mut values = vec![0.0; height * columns];
            for column in 0..columns {
                for row in column..height {
                    values[column * height + row] = ((row * 37 + column * 101) as f64 * 0.7).sin()
                        + if row == column { 300.0 } else { 0.0 };
                }
            }
            let start: Vec<f64> = (0..below * below).map(|index| (index as f64 * 0.3).cos()).collect();
            for fresh in [false, true] {
                let eliminated = |large: bool| {
                    let (mut panel, mut update) = (values.clone(), start.clone());
                    let front = FrontView { panel: &mut panel, height, columns, update: &mut update, fresh };
                    eliminate_by_blocks::<6>(front, large, &mut Vec::new())
                        .expect("the matrix is dominated by its diagonal");
                    // Values above the diagonal mean nothing.
                    let lower = |values: Vec<f64>, order: usize| -> Vec<f64> {
                        let columns = values.chunks(order.max(1)).enumerate();
                        columns.flat_map(|(column, values)| values[column.min(order)..].to_vec()).collect()
                    };
                    [lower(panel, height), lower(update, below)].concat()
                };
                let (found, expected) = (eliminated(true), eliminated(false));
                let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(
                    found.len() == expected.len() && apart < 1e-11,
                    "{height} {columns} {fresh}: {apart}"
                );
            }
        }
    }

    #[test]
    fn the_first_pivot_that_is_not_positive_is_named() {
        let (height, columns) = (2 * BLOCK, 2 * BLOCK);
        for large in [false, true] {
            let mut panel = vec![0.0; height * columns];
            panel.iter_mut().step_by(height + 1).for_each(|pivot| *pivot = 2.0);
            panel[(BLOCK + 5) * (height + 1)] = -1.0;
            let front = FrontView { panel: &mut panel, height, columns, update: &mut [], fresh: true };
            assert_eq!(eliminate_by_blocks::<6>(front, large, &mut Vec::new()), Err(BLOCK + 5));
        }
    }
}

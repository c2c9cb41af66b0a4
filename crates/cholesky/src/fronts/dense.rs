//! Partial Cholesky factorisation of one dense front.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::ops::Range;

use super::large_front;
use super::product;
use super::stored::Stored;
use super::view::FrontView;

/// From this number of operations on, copying operands of products to panels is worth that.
const LARGE_FRONT: usize = 100_000;

/// From this number of operations on, a front is divided among threads.
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
    if operations < LARGE_FRONT {
        eliminate_small::<D>(front)
    } else {
        large_front::eliminate::<D>(front, memory, operations >= LARGEST_FRONT)
    }
}

/// Eliminates the columns of a front without function calls.
#[inline(always)]
pub(super) fn eliminate_small<const D: usize>(front: FrontView<'_>) -> Result<(), usize> {
    let below = front.below();
    let FrontView { panel, height, columns, update, fresh } = front;
    eliminate_columns::<D>(panel, height, 0..columns)?;
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
///
/// Left-looking loads and stores columns once. Right-looking would rewrite all later columns every time, and memory accesses, not
/// arithmetic, limit the speed of small fronts.
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

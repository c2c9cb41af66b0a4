//! Partial Cholesky factorisation of one dense front.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Accum, MatMut, Par};

use super::large_front;
use super::product::{self, Rows, Target};
use super::stored::Stored;
use super::view::FrontView;

/// From this number of operations on, kernels that copy their operands to panels are worth that, and their calls.
const LARGE_FRONT: usize = 60_000;

/// From this number of operations on, posecut's own products are faster than faer's.
const OWN_PRODUCTS: usize = 1_000_000;

/// From this number of operations on, a front is divided among threads. Only the front decides, not the number of threads,
/// since the two methods round differently.
const LARGEST_FRONT: usize = 40_000_000;

/// Working memory of the dense kernels.
pub struct Scratch {
    pub(super) cholesky: MemBuffer,
    pub(super) panels: Vec<f64>,
}

impl Scratch {
    /// Reserves memory for the panels of products.
    pub(super) fn with_panels(self, size: usize) -> Self {
        // Pages that the system has zeroed, and that nothing touches before the first product.
        Self { panels: vec![0.0; size], ..self }
    }
}

/// How much memory for panels elimination of a front takes: none for a small one.
pub(super) fn panel_size(height: usize, columns: usize) -> usize {
    if operations(columns, height - columns) < OWN_PRODUCTS {
        0
    } else {
        product::panel_size(height, columns)
    }
}

fn operations(columns: usize, below: usize) -> usize {
    columns * (columns * columns / 3 + columns * below + below * below)
}

/// Working memory of the dense kernels for fronts of up to `columns` eliminated columns.
pub fn scratch(columns: usize) -> Scratch {
    let cholesky =
        MemBuffer::new(cholesky_in_place_scratch::<f64>(columns, Par::Seq, faer::prelude::default()));
    Scratch { cholesky, panels: Vec::new() }
}

/// Eliminates the columns of a front. On failure returns the column whose pivot was not positive.
#[inline(always)]
pub fn eliminate<const D: usize>(front: FrontView<'_>, memory: &mut Scratch) -> Result<(), usize> {
    let operations = operations(front.columns, front.below());
    if operations < LARGE_FRONT {
        eliminate_small::<D>(front)
    } else if operations < LARGEST_FRONT {
        eliminate_large(front, memory)
    } else {
        large_front::eliminate(front, memory)
    }
}

/// Eliminates the columns of a front by faer's dense kernels, and by [`product`] if that is faster.
pub(super) fn eliminate_large(front: FrontView<'_>, memory: &mut Scratch) -> Result<(), usize> {
    let below = front.below();
    let FrontView { panel, height, columns, update, fresh } = front;
    let (mut diagonal, mut rest) =
        MatMut::from_column_major_slice_mut(&mut *panel, height, columns).split_at_row_mut(columns);
    let stack = MemStack::new(&mut memory.cholesky);
    cholesky_in_place(diagonal.as_mut(), faer::prelude::default(), Par::Seq, stack, faer::prelude::default())
        .map_err(|faer::linalg::cholesky::llt::factor::LltError::NonPositivePivot { index }| index)?;
    if below > 0 {
        solve_lower_triangular_in_place(diagonal.as_ref(), rest.as_mut().transpose_mut(), Par::Seq);
        if operations(columns, below) < OWN_PRODUCTS {
            matmul(
                MatMut::from_column_major_slice_mut(update, below, below),
                BlockStructure::TriangularLower,
                if fresh { Accum::Replace } else { Accum::Add },
                rest.as_ref(),
                BlockStructure::Rectangular,
                rest.as_ref().transpose(),
                BlockStructure::Rectangular,
                -1.0,
                Par::Seq,
            );
        } else {
            let mut target = Target { values: update, height: below, first: 0, fresh };
            let rows = Rows { values: panel, height, first: columns };
            product::subtract(&mut target, rows, &mut memory.panels, false);
        }
    }
    Ok(())
}

/// Eliminates the columns of a front, left-looking by blocks of `D` columns, without function calls.
///
/// Left-looking loads and stores each block of columns once. Right-looking would rewrite all later columns for every block,
/// and memory accesses, not arithmetic, limit the speed of small fronts.
#[inline(always)]
fn eliminate_small<const D: usize>(front: FrontView<'_>) -> Result<(), usize> {
    let below = front.below();
    let FrontView { panel, height, columns, update, fresh } = front;
    for start in (0..columns).step_by(D) {
        let (done, later) = panel.split_at_mut(start * height);
        let block = &mut later[..D * height];
        subtract_products::<D>(block, height, start, done, height, start);
        factor_block::<D>(block, height, start)?;
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

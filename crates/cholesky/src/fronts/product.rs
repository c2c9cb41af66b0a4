//! The symmetric products of large fronts, `C -= A A^T` below the diagonal: nine tenths of the arithmetic of a large factorisation.
//!
//! The order of loops is Goto's (K. Goto, R. van de Geijn, "Anatomy of high-performance matrix multiplication", 2008): columns of `A`
//! are copied, some hundred at a time, to panels of a few rows that lie one after the other in memory, so that every loop reads
//! forward. A tile of `C` stays in registers over all of these columns, a group of panels in the second-level cache over all columns of
//! `C`. Since the product is symmetric, the same panels serve as rows and as columns.
//!
//! Every entry of `C` subtracts the same sums, in the same order, whatever the vector instructions, the tiles, and the threads: a fused
//! sum from zero over every [`DEPTH`] columns.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Columns of `A` in one pass over `C`. A panel of eight rows and as many columns takes a third of a first-level cache, and `C` is read
/// and written once a pass.
const DEPTH: usize = 256;
/// Rows that a group of panels has: with [`DEPTH`] columns, 0.8 MB, which fits the second-level cache of a current processor. A
/// multiple of every tile's height.
const GROUP: usize = 384;
/// Columns of `C` that a thread takes at a time.
const STRIP: usize = 192;
/// Rows that one piece of work copies to panels.
const COPIED: usize = 64;

/// Rows of a column-major matrix from `first` on.
#[derive(Clone, Copy)]
pub(super) struct Rows<'a> {
    pub(super) values: &'a [f64],
    pub(super) height: usize,
    pub(super) first: usize,
}

impl Rows<'_> {
    fn count(&self) -> usize {
        self.height - self.first
    }
}

/// Whole columns of a column-major matrix whose diagonal begins in row `first`.
pub(super) struct Target<'a> {
    pub(super) values: &'a mut [f64],
    pub(super) height: usize,
    pub(super) first: usize,
    /// Whether the old content is ignored, as if it were zero.
    pub(super) fresh: bool,
}

/// `target[first + i, j] -= sum over columns k of rows[i, k] rows[j, k]` for `i >= j`. Values just above the diagonal change, too.
///
/// `panels` is working memory, `threads` whether all threads share the work.
pub(super) fn subtract(target: &mut Target<'_>, rows: Rows<'_>, panels: &mut Vec<f64>, threads: bool) {
    let (count, height) = (rows.count(), target.height);
    if count == 0 || target.values.is_empty() {
        return;
    }
    for (pass, columns) in rows.values.chunks(DEPTH * rows.height).enumerate() {
        let depth = columns.len() / rows.height;
        let rows = Rows { values: columns, ..rows };
        let size = panel_size(count, depth);
        if panels.len() < size {
            panels.resize(size, 0.0);
        }
        let panels = &mut panels[..size];
        let copy = |(index, panels): (usize, &mut [f64])| {
            Arch::new().dispatch(Copy { rows, start: index * COPIED, depth, panels });
        };
        let pieces = COPIED * depth;
        if threads {
            panels.par_chunks_mut(pieces).enumerate().for_each(copy);
        } else {
            panels.chunks_mut(pieces).enumerate().for_each(copy);
        }
        let panels = &*panels;
        let (first, fresh) = (target.first, target.fresh && pass == 0);
        let multiply = |(index, strip): (usize, &mut [f64])| {
            Arch::new().dispatch(Multiply {
                strip: Target { values: strip, height, first, fresh },
                start: index * STRIP,
                panels,
                count,
                depth,
            });
        };
        if threads {
            target.values.par_chunks_mut(STRIP * height).enumerate().for_each(multiply);
        } else {
            target.values.chunks_mut(STRIP * height).enumerate().for_each(multiply);
        }
    }
}

/// How many numbers the panels of a front take.
pub(super) fn panel_size(height: usize, columns: usize) -> usize {
    height.next_multiple_of(COPIED) * columns.min(DEPTH)
}

/// Copies [`COPIED`] rows from `start` on to panels of as many rows as a vector has numbers; missing rows become zero.
struct Copy<'a> {
    rows: Rows<'a>,
    start: usize,
    depth: usize,
    panels: &'a mut [f64],
}

impl WithSimd for Copy<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        match S::F64_LANES {
            8 => self.copy::<8>(),
            4 => self.copy::<4>(),
            2 => self.copy::<2>(),
            _ => self.copy::<1>(),
        }
    }
}

impl Copy<'_> {
    #[inline(always)]
    fn copy<const N: usize>(self) {
        let Self { rows, start, depth, panels } = self;
        let first = rows.first + start;
        for (index, column) in rows.values.chunks_exact(rows.height).enumerate() {
            let (whole, rest) = column[first..column.len().min(first + COPIED)].as_chunks::<N>();
            let mut targets = panels.chunks_exact_mut(N * depth).map(|panel| &mut panel[index * N..][..N]);
            for (target, source) in targets.by_ref().zip(whole) {
                target.copy_from_slice(source);
            }
            for target in targets {
                target.fill(0.0);
            }
            if !rest.is_empty() {
                panels[(whole.len() * depth + index) * N..][..rest.len()].copy_from_slice(rest);
            }
        }
    }
}

/// Subtracts the products from some columns of `C`, of which the first is column `start`.
struct Multiply<'a> {
    strip: Target<'a>,
    start: usize,
    panels: &'a [f64],
    count: usize,
    depth: usize,
}

impl WithSimd for Multiply<'_> {
    type Output = ();

    /// A tile has as many vectors of rows as registers hold. Three of eight numbers with eight columns leave four of AVX-512's 32
    /// registers free. AVX2 has 16: three vectors with four columns would just fit, but in a crate of several code generation units the
    /// compiler loads two factors at a time, keeps sums in memory instead, and takes twice the time. The eight sums of two vectors are as
    /// many as its arithmetic can work on at once.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match S::F64_LANES {
            8 => self.multiply::<S, 3, 8>(simd),
            4 => self.multiply::<S, 2, 4>(simd),
            2 => self.multiply::<S, 3, 2>(simd),
            _ => self.multiply::<S, 3, 1>(simd),
        }
    }
}

impl Multiply<'_> {
    /// For tiles of `V` vectors of `N` numbers.
    #[inline(always)]
    fn multiply<S: Simd, const V: usize, const N: usize>(self, simd: S) {
        let Self { strip: Target { values, height, first, fresh }, start, panels, count, depth } = self;
        let panel = |index: usize| &panels[index * N * depth..][..N * depth];
        let (begin, end) = (start / N, (start + values.len() / height).div_ceil(N));
        let all = count.div_ceil(N);
        let group = GROUP / N;
        for group_start in (begin / group * group..all).step_by(group) {
            let group_end = all.min(group_start + group);
            for column in begin..end.min(group_end) {
                let mut row = group_start.max(column);
                while row < group_end {
                    let from = first + row * N;
                    let mut tile =
                        Tile { values: &mut values[(column - begin) * N * height..], height, from, fresh };
                    if row + V <= group_end {
                        let rows = std::array::from_fn(|vector| panel(row + vector));
                        tile.subtract::<S, V, N>(simd, rows, panel(column));
                        row += V;
                    } else {
                        tile.subtract::<S, 1, N>(simd, [panel(row)], panel(column));
                        row += 1;
                    }
                }
            }
        }
    }
}

/// A part of `C`: up to `N` columns, from row `from` on.
struct Tile<'a> {
    values: &'a mut [f64],
    height: usize,
    from: usize,
    fresh: bool,
}

impl Tile<'_> {
    /// Subtracts the product of these panels from `V` vectors of rows.
    #[inline(always)]
    fn subtract<S: Simd, const V: usize, const N: usize>(
        &mut self,
        simd: S,
        rows: [&[f64]; V],
        columns: &[f64],
    ) {
        let mut sums = [[simd.splat_f64s(0.0); N]; V];
        let columns = columns.as_chunks::<N>().0;
        let rows = rows.map(|panel| &S::as_simd_f64s(panel).0[..columns.len()]);
        for (index, factors) in columns.iter().enumerate() {
            let vectors: [S::f64s; V] = std::array::from_fn(|vector| rows[vector][index]);
            for (column, &factor) in factors.iter().enumerate() {
                let factor = simd.splat_f64s(factor);
                for (sums, &vector) in sums.iter_mut().zip(&vectors) {
                    sums[column] = simd.mul_add_f64s(vector, factor, sums[column]);
                }
            }
        }
        let Self { values, height, from, fresh } = self;
        for (index, column) in values.chunks_mut(*height).take(N).enumerate() {
            let column = &mut column[*from..];
            if let Some(column) = column.get_mut(..V * N) {
                let column = S::as_mut_simd_f64s(column).0;
                for (value, sums) in column.iter_mut().zip(&sums) {
                    let before = if *fresh { simd.splat_f64s(0.0) } else { *value };
                    *value = simd.sub_f64s(before, sums[index]);
                }
            } else {
                for (rows, sums) in column.chunks_mut(N).zip(&sums) {
                    let mut subtracted = [0.0; N];
                    S::as_mut_simd_f64s(&mut subtracted).0[0] = sums[index];
                    for (value, sum) in rows.iter_mut().zip(&subtracted) {
                        let before = if *fresh { 0.0 } else { *value };
                        *value = before - sum;
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All shapes of borders, one and several passes, several strips and groups, targets with fewer columns than rows, all to the bit.
    #[test]
    fn every_entry_is_the_documented_sum() {
        let shapes = [
            (1, 1, 1),
            (7, 3, 7),
            (8, 8, 8),
            (23, 5, 9),
            (24, 17, 24),
            (65, 40, 31),
            (200, DEPTH + 1, 200),
            (GROUP + 30, 2, STRIP + 10),
            (2 * GROUP + 5, DEPTH, 2 * GROUP + 5),
        ];
        for (count, depth, width) in shapes {
            let (first, offset) = (3, 2);
            let height = count + first;
            let values: Vec<f64> = (0..height * depth).map(|index| (index as f64 * 0.37).sin()).collect();
            let rows = Rows { values: &values, height, first };
            let before: Vec<f64> =
                (0..(count + offset) * width).map(|index| (index as f64 * 0.11).cos()).collect();
            for fresh in [false, true] {
                let subtract = |threads: bool| {
                    let mut values = before.clone();
                    let mut target =
                        Target { values: &mut values, height: count + offset, first: offset, fresh };
                    subtract(&mut target, rows, &mut Vec::new(), threads);
                    values
                };
                let found = subtract(false);
                for column in 0..width {
                    for row in column..count {
                        let place = column * (count + offset) + offset + row;
                        let mut expected = if fresh { 0.0 } else { before[place] };
                        for pass in values.chunks(DEPTH * height) {
                            let factors = pass
                                .chunks(height)
                                .map(|source| (source[first + row], source[first + column]));
                            expected -= factors.fold(0.0, |sum, (a, b): (f64, f64)| a.mul_add(b, sum));
                        }
                        assert_eq!(found[place], expected, "{count} {depth} {width}: {row} {column}");
                    }
                    assert_eq!(
                        found[column * (count + offset)..][..offset.min(column)],
                        before[column * (count + offset)..][..offset.min(column)]
                    );
                }
                assert!(subtract(true) == found);
            }
        }
    }
}

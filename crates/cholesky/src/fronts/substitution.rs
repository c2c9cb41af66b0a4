//! The triangular solves, front by front.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::{Arch, Simd, WithSimd};
use nalgebra::SVector;

use super::dense::{products, subtract_columns};
use super::factor::Factor;
use super::stored::Stored;
use crate::symbolic::{Front, Symbolic};

impl<const D: usize, S: Stored> Factor<D, S> {
    /// Solves `A x = b`; `values` holds `b` and becomes `x`.
    pub fn solve(&mut self, symbolic: &Symbolic, values: &mut [SVector<f64, D>]) {
        for (value, &variable) in self.permuted.chunks_exact_mut(D).zip(&symbolic.order) {
            value.copy_from_slice(values[variable].as_slice());
        }
        Arch::new().dispatch(Substitute { factor: self, symbolic });
        for (value, &variable) in self.permuted.chunks_exact(D).zip(&symbolic.order) {
            values[variable].as_mut_slice().copy_from_slice(value);
        }
    }
}

/// Both triangular solves for one set of vector instructions. Not a closure: a closure would not be inlined.
struct Substitute<'a, const D: usize, S> {
    factor: &'a mut Factor<D, S>,
    symbolic: &'a Symbolic,
}

impl<const D: usize, N: Stored> WithSimd for Substitute<'_, D, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Factor { panels, permuted, local, .. } = self.factor;
        for front in &self.symbolic.fronts {
            forward::<D, N>(self.symbolic, front, panels, permuted, local);
        }
        for front in self.symbolic.fronts.iter().rev() {
            backward::<D, N>(self.symbolic, front, panels, permuted, local);
        }
    }
}

/// The columns of a front, and working memory for all its rows with the front's own values in it.
#[inline(always)]
fn open<'a, const D: usize, S: Stored>(
    front: &Front,
    panels: &'a [S],
    x: &[f64],
    local: &'a mut [f64],
) -> (&'a [S], &'a mut [f64]) {
    let height = front.height() * D;
    let columns = front.columns * D;
    let local = &mut local[..height];
    local[..columns].copy_from_slice(&x[front.first * D..][..columns]);
    (&panels[front.panel * D * D..][..columns * height], local)
}

/// The reciprocals of a block's pivots. They do not wait for the values that are solved for, as quotients would.
#[inline(always)]
fn reciprocals<const D: usize, S: Stored>(block: &[S], height: usize, start: usize) -> [f64; D] {
    std::array::from_fn(|column| 1.0 / block[column * height + start + column].widened())
}

/// `x_1 = L^-1 x_1`, then `x_2 -= M x_1`, for the columns of one front. `local` is working memory.
#[inline(always)]
pub(crate) fn forward<const D: usize, S: Stored>(
    symbolic: &Symbolic,
    front: &Front,
    panels: &[S],
    x: &mut [f64],
    local: &mut [f64],
) {
    let (panel, local) = open::<D, S>(front, panels, x, local);
    let (height, columns) = (local.len(), front.columns * D);
    local[columns..].fill(0.0);
    for (block_index, block) in panel.chunks_exact(D * height).enumerate() {
        let start = block_index * D;
        let mut solved = [0.0; D];
        let reciprocals = reciprocals::<D, S>(block, height, start);
        for column in 0..D {
            let values = &block[column * height + start..][..D];
            let value = local[start + column] * reciprocals[column];
            solved[column] = value;
            local[start + column] = value;
            for row in column + 1..D {
                local[start + row] -= value * values[row].widened();
            }
        }
        let target = &mut local[start + D..];
        let sources: [&[S]; D] =
            std::array::from_fn(|column| &block[column * height + start + D..][..target.len()]);
        subtract_columns(target, &sources, &solved);
    }
    x[front.first * D..][..columns].copy_from_slice(&local[..columns]);
    for (&row, values) in symbolic.rows[front.rows.clone()].iter().zip(local[columns..].chunks_exact(D)) {
        for (target, value) in x[row * D..][..D].iter_mut().zip(values) {
            *target += value;
        }
    }
}

/// `x_1 = L^-T (x_1 - M^T x_2)` for the columns of one front. `local` is working memory.
#[inline(always)]
pub(crate) fn backward<const D: usize, S: Stored>(
    symbolic: &Symbolic,
    front: &Front,
    panels: &[S],
    x: &mut [f64],
    local: &mut [f64],
) {
    let (panel, local) = open::<D, S>(front, panels, x, local);
    let (height, columns) = (local.len(), front.columns * D);
    for (&row, values) in symbolic.rows[front.rows.clone()].iter().zip(local[columns..].chunks_exact_mut(D)) {
        values.copy_from_slice(&x[row * D..][..D]);
    }
    for (block_index, block) in panel.chunks_exact(D * height).enumerate().rev() {
        let start = block_index * D;
        let known = &local[start + D..];
        let sources: [&[S]; D] =
            std::array::from_fn(|column| &block[column * height + start + D..][..known.len()]);
        // Partial sums hide the latency of an addition; the more columns there are, the fewer each needs.
        let sums =
            if D < 4 { products::<D, 8, S>(&sources, known) } else { products::<D, 4, S>(&sources, known) };
        let reciprocals = reciprocals::<D, S>(block, height, start);
        for column in (0..D).rev() {
            let values = &block[column * height + start..][..D];
            let mut sum = local[start + column] - sums[column];
            for row in column + 1..D {
                sum -= values[row].widened() * local[start + row];
            }
            local[start + column] = sum * reciprocals[column];
        }
    }
    x[front.first * D..][..columns].copy_from_slice(&local[..columns]);
}

//! The triangular solves, front by front.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::{Arch, Simd, WithSimd};
use nalgebra::SVector;

use super::dense::{products_of, subtract_columns};
use super::factor::Factor;
use crate::scalar::Scalar;
use crate::symbolic::{Front, Symbolic};

impl<const D: usize, T: Scalar> Factor<D, T> {
    /// Solves `A x = b`; `values` holds `b` and becomes `x`.
    pub fn solve(&mut self, symbolic: &Symbolic, values: &mut [SVector<f64, D>]) {
        for (value, &variable) in self.permuted.chunks_exact_mut(D).zip(&symbolic.order) {
            for (value, source) in value.iter_mut().zip(values[variable].as_slice()) {
                *value = T::of(*source);
            }
        }
        Arch::new().dispatch(Substitute { factor: self, symbolic });
        for (value, &variable) in self.permuted.chunks_exact(D).zip(&symbolic.order) {
            for (target, value) in values[variable].as_mut_slice().iter_mut().zip(value) {
                *target = value.double();
            }
        }
    }
}

/// Both triangular solves for one set of vector instructions. Not a closure: a closure would not be inlined.
struct Substitute<'a, const D: usize, T> {
    factor: &'a mut Factor<D, T>,
    symbolic: &'a Symbolic,
}

impl<const D: usize, T: Scalar> WithSimd for Substitute<'_, D, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Factor { panels, permuted, local, .. } = self.factor;
        for front in &self.symbolic.fronts {
            forward::<D, T>(self.symbolic, front, panels, permuted, local);
        }
        for front in self.symbolic.fronts.iter().rev() {
            backward::<D, T>(self.symbolic, front, panels, permuted, local);
        }
    }
}

/// The columns of a front, and working memory for all its rows with the front's own values in it.
#[inline(always)]
fn open<'a, const D: usize, T: Scalar>(
    front: &Front,
    panels: &'a [T],
    x: &[T],
    local: &'a mut [T],
) -> (&'a [T], &'a mut [T]) {
    let height = front.height() * D;
    let columns = front.columns * D;
    let local = &mut local[..height];
    local[..columns].copy_from_slice(&x[front.first * D..][..columns]);
    (&panels[front.panel * D * D..][..columns * height], local)
}

/// The reciprocals of a block's pivots. They do not wait for the values that are solved for, as quotients would.
#[inline(always)]
fn reciprocals<const D: usize, T: Scalar>(block: &[T], height: usize, start: usize) -> [T; D] {
    std::array::from_fn(|column| block[column * height + start + column].reciprocal())
}

/// `x_1 = L^-1 x_1`, then `x_2 -= M x_1`, for the columns of one front. `local` is working memory.
#[inline(always)]
pub(crate) fn forward<const D: usize, T: Scalar>(
    symbolic: &Symbolic,
    front: &Front,
    panels: &[T],
    x: &mut [T],
    local: &mut [T],
) {
    let (panel, local) = open::<D, T>(front, panels, x, local);
    let (height, columns) = (local.len(), front.columns * D);
    local[columns..].fill(T::ZERO);
    for (block_index, block) in panel.chunks_exact(D * height).enumerate() {
        let start = block_index * D;
        let mut solved = [T::ZERO; D];
        let reciprocals = reciprocals::<D, T>(block, height, start);
        for column in 0..D {
            let values = &block[column * height + start..][..D];
            let value = local[start + column] * reciprocals[column];
            solved[column] = value;
            local[start + column] = value;
            for row in column + 1..D {
                local[start + row] -= value * values[row];
            }
        }
        let target = &mut local[start + D..];
        let sources: [&[T]; D] =
            std::array::from_fn(|column| &block[column * height + start + D..][..target.len()]);
        subtract_columns(target, &sources, &solved);
    }
    x[front.first * D..][..columns].copy_from_slice(&local[..columns]);
    for (&row, values) in symbolic.rows[front.rows.clone()].iter().zip(local[columns..].chunks_exact(D)) {
        for (target, value) in x[row * D..][..D].iter_mut().zip(values) {
            *target += *value;
        }
    }
}

/// `x_1 = L^-T (x_1 - M^T x_2)` for the columns of one front. `local` is working memory.
#[inline(always)]
pub(crate) fn backward<const D: usize, T: Scalar>(
    symbolic: &Symbolic,
    front: &Front,
    panels: &[T],
    x: &mut [T],
    local: &mut [T],
) {
    let (panel, local) = open::<D, T>(front, panels, x, local);
    let (height, columns) = (local.len(), front.columns * D);
    for (&row, values) in symbolic.rows[front.rows.clone()].iter().zip(local[columns..].chunks_exact_mut(D)) {
        values.copy_from_slice(&x[row * D..][..D]);
    }
    for (block_index, block) in panel.chunks_exact(D * height).enumerate().rev() {
        let start = block_index * D;
        let known = &local[start + D..];
        let sources: [&[T]; D] =
            std::array::from_fn(|column| &block[column * height + start + D..][..known.len()]);
        // Partial sums hide the latency of an addition; the more columns there are, the fewer each needs.
        let sums = if D < 4 {
            products_of::<D, 8, T>(&sources, known)
        } else {
            products_of::<D, 4, T>(&sources, known)
        };
        let reciprocals = reciprocals::<D, T>(block, height, start);
        for column in (0..D).rev() {
            let values = &block[column * height + start..][..D];
            let mut sum = local[start + column] - sums[column];
            for row in column + 1..D {
                sum -= values[row] * local[start + row];
            }
            local[start + column] = sum * reciprocals[column];
        }
    }
    x[front.first * D..][..columns].copy_from_slice(&local[..columns]);
}

//! A vector register that holds a number of each edge, and its arithmetic.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::ops::{Add, Mul, Neg, Sub};

use faer::traits::pulp::{Simd, bytemuck};

/// The most lanes that a register has.
pub(crate) const MOST: usize = 8;

/// One number of each edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lane<S: Simd> {
    pub(super) simd: S,
    values: S::f64s,
}

impl<S: Simd> Lane<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub(super) fn splat(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat_f64s(value) }
    }

    /// The number of each lane, by its index.
    #[inline(always)]
    pub(super) fn gather(simd: S, of: impl Fn(usize) -> f64) -> Self {
        // Written out: a loop over the lanes would go through memory.
        let values = match S::F64_LANES {
            1 => bytemuck::pod_read_unaligned(bytemuck::bytes_of(&[of(0)])),
            2 => bytemuck::pod_read_unaligned(bytemuck::bytes_of(&[of(0), of(1)])),
            4 => bytemuck::pod_read_unaligned(bytemuck::bytes_of(&[of(0), of(1), of(2), of(3)])),
            MOST => bytemuck::pod_read_unaligned(bytemuck::bytes_of(&[
                of(0),
                of(1),
                of(2),
                of(3),
                of(4),
                of(5),
                of(6),
                of(7),
            ])),
            lanes => unreachable!("{lanes} lanes"),
        };
        Self { simd, values }
    }

    /// The number in every lane.
    #[inline(always)]
    pub(super) fn constant(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// The numbers.
    #[inline(always)]
    pub(super) fn numbers(&self) -> &[f64] {
        bytemuck::cast_slice(std::slice::from_ref(&self.values))
    }

    /// `self * factor + summand`.
    #[inline(always)]
    pub(super) fn times_plus(self, factor: Self, summand: Self) -> Self {
        Self { values: self.simd.mul_add_e_f64s(self.values, factor.values, summand.values), ..self }
    }

    /// `summand - self * factor`.
    #[inline(always)]
    pub(super) fn times_from(self, factor: Self, summand: Self) -> Self {
        (-self).times_plus(factor, summand)
    }

    /// `1 / self`.
    #[inline(always)]
    pub(super) fn reciprocal(self) -> Self {
        Self { values: self.simd.div_f64s(self.constant(1.0).values, self.values), ..self }
    }

    /// The rows of four columns of four numbers. Only for registers of four lanes.
    #[inline(always)]
    pub(super) fn transposed([a, b, c, d]: &[Self; 4]) -> [Self; 4] {
        let [e, f, g, h] = a.simd.interleave_shfl_f64s([a.values, b.values, c.values, d.values]);
        [
            Self { values: e, ..*a },
            Self { values: f, ..*a },
            Self { values: g, ..*a },
            Self { values: h, ..*a },
        ]
    }

    /// Whether every number is at most `limit`; not if one is not a number.
    #[inline(always)]
    pub(super) fn at_most(&self, limit: f64) -> bool {
        self.numbers().iter().all(|&number| number <= limit)
    }
}

impl<S: Simd> Add for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { values: self.simd.add_f64s(self.values, other.values), ..self }
    }
}

impl<S: Simd> Sub for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { values: self.simd.sub_f64s(self.values, other.values), ..self }
    }
}

impl<S: Simd> Mul for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { values: self.simd.mul_f64s(self.values, other.values), ..self }
    }
}

impl<S: Simd> Neg for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { values: self.simd.neg_f64s(self.values), ..self }
    }
}

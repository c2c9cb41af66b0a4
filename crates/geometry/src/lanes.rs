//! Several numbers, one in each lane of a vector register, and their arithmetic.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use std::ops::{Add, Div, Mul, Neg, Sub};

use pulp::{Simd, bytemuck};

/// The number of lanes that are stored together: the widest register of any machine.
pub const WIDTH: usize = 8;

/// Eight numbers on one cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Wide(pub [f64; WIDTH]);

impl Default for Wide {
    fn default() -> Self {
        Self([0.0; WIDTH])
    }
}

/// As many numbers as a register holds. Operators are never fused, so that lanes round like single numbers on every machine;
/// [`times_plus`](Self::times_plus) and [`times_from`](Self::times_from) are fused where the machine can.
#[derive(Clone, Copy, Debug)]
pub struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Self { simd, values: simd.splat_f64s(value) }
    }

    /// The number of each lane, by its index.
    #[inline(always)]
    pub fn gather(simd: S, of: impl Fn(usize) -> f64) -> Self {
        // Written out: a loop over the lanes would go through memory.
        let values = match S::F64_LANES {
            1 => bytemuck::pod_read_unaligned(bytemuck::bytes_of(&[of(0)])),
            2 => bytemuck::pod_read_unaligned(bytemuck::bytes_of(&[of(0), of(1)])),
            4 => bytemuck::pod_read_unaligned(bytemuck::bytes_of(&[of(0), of(1), of(2), of(3)])),
            WIDTH => bytemuck::pod_read_unaligned(bytemuck::bytes_of(&[
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

    /// The lanes from `first` on, a multiple of the register's.
    #[inline(always)]
    pub fn load(simd: S, wide: &Wide, first: usize) -> Self {
        Self { simd, values: S::as_simd_f64s(&wide.0[first..]).0[0] }
    }

    /// Loads three vectors. Written out, because an array's `map` is a call, which would be compiled for the oldest
    /// machine.
    #[inline(always)]
    pub fn load_three(simd: S, [x, y, z]: &[Wide; 3], first: usize) -> [Self; 3] {
        [Self::load(simd, x, first), Self::load(simd, y, first), Self::load(simd, z, first)]
    }

    /// Loads four vectors.
    #[inline(always)]
    pub fn load_four(simd: S, [w, x, y, z]: &[Wide; 4], first: usize) -> [Self; 4] {
        [
            Self::load(simd, w, first),
            Self::load(simd, x, first),
            Self::load(simd, y, first),
            Self::load(simd, z, first),
        ]
    }

    /// Writes the lanes from `first` on.
    #[inline(always)]
    pub fn store(self, wide: &mut Wide, first: usize) {
        S::as_mut_simd_f64s(&mut wide.0[first..]).0[0] = self.values;
    }

    /// Magnitudes.
    #[must_use]
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self { values: self.simd.abs_f64s(self.values), ..self }
    }

    /// Square roots.
    #[must_use]
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Self { values: self.simd.sqrt_f64s(self.values), ..self }
    }

    /// The lanes where these are less than others.
    #[inline(always)]
    pub fn less_than(self, other: Self) -> Mask<S> {
        Mask { simd: self.simd, lanes: self.simd.less_than_f64s(self.values, other.values) }
    }

    /// The number in every lane.
    #[must_use]
    #[inline(always)]
    pub fn constant(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// The numbers.
    #[inline(always)]
    pub fn numbers(&self) -> &[f64] {
        bytemuck::cast_slice(std::slice::from_ref(&self.values))
    }

    /// `self * factor + summand`.
    #[must_use]
    #[inline(always)]
    pub fn times_plus(self, factor: Self, summand: Self) -> Self {
        Self { values: self.simd.mul_add_e_f64s(self.values, factor.values, summand.values), ..self }
    }

    /// `summand - self * factor`.
    #[must_use]
    #[inline(always)]
    pub fn times_from(self, factor: Self, summand: Self) -> Self {
        (-self).times_plus(factor, summand)
    }

    /// `1 / self`.
    #[must_use]
    #[inline(always)]
    pub fn reciprocal(self) -> Self {
        self.constant(1.0) / self
    }

    /// The rows of four columns of four numbers. Only for registers of four lanes.
    #[inline(always)]
    pub fn transposed([a, b, c, d]: &[Self; 4]) -> [Self; 4] {
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
    pub fn at_most(&self, limit: f64) -> bool {
        self.numbers().iter().all(|&number| number <= limit)
    }

    /// c_0 + c_1 x + c_2 x^2 + … by Horner's rule.
    #[must_use]
    #[inline(always)]
    pub fn polynomial(self, coefficients: &[f64]) -> Self {
        let mut sum = Self::splat(self.simd, 0.0);
        for &coefficient in coefficients.iter().rev() {
            sum = sum * self + Self::splat(self.simd, coefficient);
        }
        sum
    }
}

/// A truth value for each lane.
#[derive(Clone, Copy, Debug)]
pub struct Mask<S: Simd> {
    simd: S,
    lanes: S::m64s,
}

impl<S: Simd> Mask<S> {
    /// The lanes where both hold.
    #[must_use]
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self { lanes: self.simd.and_m64s(self.lanes, other.lanes), ..self }
    }

    /// For each lane, one number or the other.
    #[inline(always)]
    pub fn select(self, if_true: Lanes<S>, if_false: Lanes<S>) -> Lanes<S> {
        Lanes { simd: self.simd, values: self.simd.select_f64s(self.lanes, if_true.values, if_false.values) }
    }

    /// One bit for each lane.
    #[inline(always)]
    pub fn bits(self) -> u64 {
        let one = Lanes::splat(self.simd, 1.0);
        let mut flags = Wide::default();
        self.select(one, Lanes::splat(self.simd, 0.0)).store(&mut flags, 0);
        let mut bits = 0;
        for (lane, flag) in flags.0.iter().enumerate().take(S::F64_LANES) {
            bits |= u64::from(*flag != 0.0) << lane;
        }
        bits
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { values: self.simd.add_f64s(self.values, other.values), ..self }
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { values: self.simd.sub_f64s(self.values, other.values), ..self }
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self { values: self.simd.mul_f64s(self.values, other.values), ..self }
    }
}

impl<S: Simd> Mul<f64> for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::splat(self.simd, factor)
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self { values: self.simd.div_f64s(self.values, other.values), ..self }
    }
}

impl<S: Simd> Neg for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self { values: self.simd.neg_f64s(self.values), ..self }
    }
}

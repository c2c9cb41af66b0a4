//! The even functions `c_n` of an angle in `Exp`, by their power series: `c_0 = cos a`, `c_1 = sin a / a`, `c_2 = (1 - cos a) / a^2`,
//! `c_3 = (a - sin a) / a^3`.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Simd;
use posecut_geometry::trigonometric::{TERMS, coefficients};

use posecut_geometry::lanes::Lanes;

const SECOND: [f64; TERMS] = coefficients(2);
const THIRD: [f64; TERMS] = coefficients(3);

/// `c_2` of the angle with this square.
#[inline(always)]
pub(super) fn second<S: Simd>(squared: Lanes<S>) -> Lanes<S> {
    series(squared, &SECOND)
}

/// `c_3` of the angle with this square.
#[inline(always)]
pub(super) fn third<S: Simd>(squared: Lanes<S>) -> Lanes<S> {
    series(squared, &THIRD)
}

/// `1 - squared * c`: `c_0` from `c_2`.
#[inline(always)]
pub(super) fn one_minus<S: Simd>(squared: Lanes<S>, c: Lanes<S>) -> Lanes<S> {
    squared.times_from(c, squared.constant(1.0))
}

/// Horner's rule.
#[inline(always)]
fn series<S: Simd>(x: Lanes<S>, coefficients: &[f64; TERMS]) -> Lanes<S> {
    let mut sum = x.constant(coefficients[TERMS - 1]);
    let mut term = TERMS - 1;
    while term > 0 {
        term -= 1;
        sum = sum.times_plus(x, x.constant(coefficients[term]));
    }
    sum
}

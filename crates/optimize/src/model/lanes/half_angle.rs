//! The logarithm of a rotation from the tangent of half its angle.
//!
//! With `t = tan(a/2)` and `u = t^2`, `A(u) = atan(t)/t` is smooth at 0, and it is all that is needed: `a = 2 t A`,
//! `(a/2) cot(a/2) = A`, and the factor of `[r]^2` in the inverse of `V`, `h = (1 - A) / a^2 = B / (4 A^2)` with `B = (1 - A)/u`. Nothing
//! cancels. Both follow from `C = (1/3 - B)/u = 1/5 - u/7 + u^2/9 - ...`.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Simd;

use posecut_geometry::lanes::Lanes;

/// The largest `u`: `a` is then 45 degrees.
pub(super) const LARGEST: f64 = 0.1715;

/// Terms of the series of `C`, an even number. The first one left out changes `A` by `LARGEST^20 / 41`, 1e-17.
const TERMS: usize = 18;

/// `(-1)^k / (2 k + 5)`.
const COEFFICIENTS: [f64; TERMS] = {
    let mut coefficients = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        coefficients[k] = if k % 2 == 0 { 1.0 } else { -1.0 } / (2 * k + 5) as f64;
        k += 1;
    }
    coefficients
};

/// The functions at one `u`.
#[derive(Clone, Copy)]
pub(super) struct HalfAngle<S: Simd> {
    pub(super) u: Lanes<S>,
    /// `A`.
    pub(super) a: Lanes<S>,
    /// `B`.
    pub(super) b: Lanes<S>,
    /// `C`.
    pub(super) c: Lanes<S>,
}

impl<S: Simd> HalfAngle<S> {
    /// The functions at the square of the tangent of half the angle, at most [`LARGEST`].
    #[inline(always)]
    pub(super) fn of_squared_tangent(u: Lanes<S>) -> Self {
        // Even and odd terms apart: two short chains of operations instead of a long one.
        let square = u * u;
        let mut even = u.constant(0.0);
        let mut odd = u.constant(0.0);
        let mut term = TERMS;
        while term > 0 {
            term -= 2;
            even = even.times_plus(square, u.constant(COEFFICIENTS[term]));
            odd = odd.times_plus(square, u.constant(COEFFICIENTS[term + 1]));
        }
        let c = odd.times_plus(u, even);
        let b = u.times_from(c, u.constant(1.0 / 3.0));
        let a = u.times_from(b, u.constant(1.0));
        Self { u, a, b, c }
    }

    /// `dA/da / -t`: `(1 + u) (1/3 + u C/2) - u/2`.
    #[inline(always)]
    pub(super) fn slope_of_a(&self) -> Lanes<S> {
        let Self { u, c, .. } = *self;
        let half = u.constant(0.5);
        let bracket = (u * c).times_plus(half, u.constant(1.0 / 3.0));
        u.times_from(half, (u.constant(1.0) + u) * bracket)
    }

    /// `h`, and its derivative by the squared angle.
    #[inline(always)]
    pub(super) fn half_cotangent(&self) -> (Lanes<S>, Lanes<S>) {
        let Self { u, a, b, c } = *self;
        let inverse = a.reciprocal();
        let quarter = inverse * inverse * u.constant(0.25);
        let one = u.constant(1.0);
        // `(1 + u) B'`, since `2 u A' = 1/(1 + u) - A`.
        let b_slope = ((one + u) * c).times_plus(u.constant(3.0), -one) * u.constant(0.5);
        let b_twice = b + b;
        let bracket = b_slope.times_plus(b_twice.times_plus(u, a), b_twice * b * (one + u));
        (b * quarter, bracket * quarter * quarter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::traits::pulp::Scalar;

    #[test]
    fn the_functions_are_those_of_the_angle() {
        for angle in [0.0_f64, 1e-9, 1e-3, 0.1, 0.3, 0.6, 0.785] {
            let tangent = (0.5 * angle).tan();
            let functions = HalfAngle::of_squared_tangent(Lanes::splat(Scalar, tangent * tangent));
            let number = |lane: Lanes<Scalar>| lane.numbers()[0];
            assert!((2.0 * tangent * number(functions.a) - angle).abs() <= 4e-16 * angle, "{angle}");
            let half = 0.5 * angle;
            let (h, slope) = functions.half_cotangent();
            if angle > 0.05 {
                let (sine, cosine) = half.sin_cos();
                let closed = (1.0 - half * cosine / sine) / (angle * angle);
                assert!((number(h) / closed - 1.0).abs() < 1e-12, "{angle}: {} {closed}", number(h));
                let change = (cosine / sine - half / (sine * sine)) / (8.0 * half);
                let closed_slope = -(change + closed) / (angle * angle);
                assert!((number(slope) / closed_slope - 1.0).abs() < 1e-8, "{angle}: {}", number(slope));
                let derivative = 0.5 * cosine / sine - 0.5 * half / (sine * sine);
                let found = -tangent * number(functions.slope_of_a());
                assert!((found / derivative - 1.0).abs() < 1e-11, "{angle}: {found} {derivative}");
            } else {
                assert!((number(h) - 1.0 / 12.0).abs() < 1e-5 && (number(slope) - 1.0 / 720.0).abs() < 1e-6);
                assert!((number(functions.slope_of_a()) - 1.0 / 3.0).abs() < 1e-5);
            }
        }
    }
}

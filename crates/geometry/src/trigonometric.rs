//! The entire functions in the closed forms of exp, log and their Jacobians.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

/// If the squared angle is below this, the power series is used; above it the closed form loses less than two digits.
pub const SERIES_LIMIT: f64 = 1.0;

/// Terms of a power series, which reach 1e-19 below [`SERIES_LIMIT`].
pub const TERMS: usize = 9;

/// `c_n(a) = sum_k (-1)^k a^(2k) / (2k + n)!` for n = 0 to 5, at one angle `a` (radians).
///
/// `c_0 = cos a`, `c_1 = sin a / a`, `c_2 = (1 - cos a) / a^2`, `c_3 = (a - sin a) / a^3`,
/// `c_4 = (a^2/2 - 1 + cos a) / a^4`, `c_5 = (a^3/6 - a + sin a) / a^5`. They are even, smooth at 0, and related by
/// `c_n = 1/n! - a^2 c_(n+2)`, so that near zero two series give all six.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Trigonometric {
    pub(crate) c1: f64,
    pub(crate) c2: f64,
    pub(crate) c3: f64,
    pub(crate) c4: f64,
    pub(crate) c5: f64,
}

impl Trigonometric {
    /// The functions at the angle with this square. Relative error about 1e-15.
    #[inline(always)]
    pub(crate) fn of_squared_angle(squared: f64) -> Self {
        if squared < SERIES_LIMIT {
            let c4 = series(squared, &FOURTH);
            let c5 = series(squared, &FIFTH);
            let c3 = 1.0 / 6.0 - squared * c5;
            let c2 = 0.5 - squared * c4;
            let c1 = 1.0 - squared * c3;
            return Self { c1, c2, c3, c4, c5 };
        }
        let angle = squared.sqrt();
        let (sine, cosine) = angle.sin_cos();
        let c1 = sine / angle;
        let c2 = (1.0 - cosine) / squared;
        let c3 = (1.0 - c1) / squared;
        Self { c1, c2, c3, c4: (0.5 - c2) / squared, c5: (1.0 / 6.0 - c3) / squared }
    }
}

/// `sum_k (-1)^k x^k / (2k + n)!` by Horner's rule.
#[inline(always)]
fn series(x: f64, coefficients: &[f64; TERMS]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient)
}

/// `(-1)^k / (2k + n)!`, the coefficients of `c_n` in the squared angle. Computed at compile time: a division takes as long as the rest of
/// a term.
pub const fn coefficients(n: usize) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        let mut factorial = 1.0;
        let mut factor = 2;
        while factor <= 2 * k + n {
            factorial *= factor as f64;
            factor += 1;
        }
        coefficients[k] = if k % 2 == 0 { 1.0 / factorial } else { -1.0 / factorial };
        k += 1;
    }
    coefficients
}

const FOURTH: [f64; TERMS] = coefficients(4);
const FIFTH: [f64; TERMS] = coefficients(5);

/// `(1 - (a/2) cot(a/2)) / a^2`, from the square of the angle `a`; even, 1/12 at 0, and smooth up to two pi.
///
/// It is the only function in the inverse of `V` (the left Jacobian of rotations) that is not rational, and it stays
/// well-conditioned at pi, where the usual `(1 + cos a) / (2 a sin a)` is 0/0.
#[inline(always)]
pub(crate) fn half_cotangent(squared: f64) -> f64 {
    if squared < 0.04 {
        // Bernoulli numbers: |B_2k| / (2k)! x^(k-1); the next term is below 1e-17.
        return 1.0 / 12.0
            + squared
                * (1.0 / 720.0
                    + squared
                        * (1.0 / 30_240.0
                            + squared
                                * (1.0 / 1_209_600.0
                                    + squared
                                        * (1.0 / 47_900_160.0 + squared * 5.284_190_138_687_493e-10))));
    }
    let half = 0.5 * squared.sqrt();
    (1.0 - half / half.tan()) / squared
}

/// The derivative of [`half_cotangent`] by its argument; 1/720 at 0. Where the closed form begins, rounding is
/// about 1e-10 of it: the Jacobians, where it is multiplied by the cube of the angle, do not show that.
#[inline(always)]
pub(crate) fn half_cotangent_slope(squared: f64) -> f64 {
    if squared < 0.04 {
        return 1.0 / 720.0
            + squared
                * (2.0 / 30_240.0
                    + squared
                        * (3.0 / 1_209_600.0
                            + squared * (4.0 / 47_900_160.0 + squared * (5.0 * 5.284_190_138_687_493e-10))));
    }
    let half = 0.5 * squared.sqrt();
    let (sine, cosine) = half.sin_cos();
    let change = (cosine / sine - half / (sine * sine)) / (8.0 * half);
    -(change + half_cotangent(squared)) / squared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_forms_meet_where_they_change_over() {
        let below = Trigonometric::of_squared_angle(1.0 - f64::EPSILON);
        let above = Trigonometric::of_squared_angle(1.0);
        let pairs = [
            (below.c1, above.c1),
            (below.c2, above.c2),
            (below.c3, above.c3),
            (below.c4, above.c4),
            (below.c5, above.c5),
        ];
        for (series, closed) in pairs {
            assert!((series / closed - 1.0).abs() < 1e-13, "{series} {closed}");
        }
        assert!((half_cotangent(0.04) / half_cotangent(0.04 - 1e-17) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn the_slope_of_the_half_cotangent_is_its_derivative() {
        for squared in [0.0_f64, 1e-6, 0.01, 0.039, 0.041, 0.3, 2.0, 9.8] {
            let step = 1e-4;
            let difference = (half_cotangent(squared + step) - half_cotangent(squared - step)) / (2.0 * step);
            let slope = half_cotangent_slope(squared);
            assert!((slope - difference).abs() < 1e-9, "{squared}: {slope:e} {difference:e}");
        }
        assert!((half_cotangent_slope(0.04) / half_cotangent_slope(0.04 - 1e-16) - 1.0).abs() < 1e-9);
    }

    /// The relative error of the closed form grows as the inverse square of the angle, so it can check the series only near
    /// the limit.
    #[test]
    fn the_series_of_the_half_cotangent_is_right_to_its_last_term() {
        for squared in [0.02_f64, 0.03, 0.039] {
            let half = 0.5 * squared.sqrt();
            let closed = (1.0 - half / half.tan()) / squared;
            let series = half_cotangent(squared);
            assert!((series - closed).abs() < 4e-15, "{series:e} {closed:e}");
        }
    }
}

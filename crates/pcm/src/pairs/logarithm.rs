//! The logarithm of a rigid motion, for several motions at once.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use pulp::Simd;

use posecut_geometry::lanes::Lanes;

/// The cosine of half a radian. For rotations of less than a radian, series are enough.
const HALF_COSINE: f64 = 0.877_582_561_890_372_8;

/// The number of terms whose sum is exact to rounding at u = tan(pi / 8).
const TERMS: usize = 21;
/// The same at u = tan(1 / 4).
const TERMS_NEAR: usize = 14;

/// atan(u) / u = sum (-1)^k y^k / (2k + 1), y = u^2.
const ARCTANGENT: [f64; TERMS] = {
    let mut coefficients = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        coefficients[k] = sign / (2 * k + 1) as f64;
        k += 1;
    }
    coefficients
};

/// Numerators and denominators of the Bernoulli numbers `|B_2|`, `|B_4|`, ….
const BERNOULLI: [(f64, f64); 11] = [
    (1.0, 6.0),
    (1.0, 30.0),
    (1.0, 42.0),
    (1.0, 30.0),
    (5.0, 66.0),
    (691.0, 2730.0),
    (7.0, 6.0),
    (3617.0, 510.0),
    (43_867.0, 798.0),
    (174_611.0, 330.0),
    (854_513.0, 138.0),
];

/// (1 - (a/2) cot(a/2)) / a^2 = sum `|B_2k|` / (2k)! a^(2k - 2).
const HALF_COTANGENT: [f64; BERNOULLI.len()] = {
    let mut coefficients = [0.0; BERNOULLI.len()];
    let mut factorial = 1.0;
    let mut k = 0;
    while k < BERNOULLI.len() {
        factorial *= ((2 * k + 1) * (2 * k + 2)) as f64;
        coefficients[k] = BERNOULLI[k].0 / (BERNOULLI[k].1 * factorial);
        k += 1;
    }
    coefficients
};

/// The logarithm of motions of space, given by translation and quaternion (w, x, y, z), as (translation, rotation).
///
/// With s = sin(a/2) and w = cos(a/2), the rotation is (x, y, z) a / s. For u = tan(a/4) = s / (1 + w), the factor a / s is
/// 4 atan(u) / (u (1 + w)): up to a radian this needs no branch, no root and no call. Only the lanes of `asked`, one bit
/// each, must be right.
#[inline(always)]
pub(crate) fn logarithm<S: Simd>(
    simd: S,
    translation: [Lanes<S>; 3],
    [w, x, y, z]: [Lanes<S>; 4],
    asked: u64,
) -> ([Lanes<S>; 3], [Lanes<S>; 3]) {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    // q and -q are the same rotation; the one with w >= 0 is the shorter way.
    let sign = w.less_than(zero).select(-one, one);
    let w = w * sign;
    let squared_sine = x * x + y * y + z * z;
    let inverse = one / (one + w);
    let squared_tangent = squared_sine * inverse * inverse;
    let mut ratio = squared_tangent.polynomial(&ARCTANGENT[..TERMS_NEAR]) * inverse * 4.0;
    let mut curvature = (ratio * ratio * squared_sine).polynomial(&HALF_COTANGENT);
    let near = Lanes::splat(simd, HALF_COSINE).less_than(w);
    if asked & !near.bits() != 0 {
        // Halves the angle once more: tan(a/8) = u / (1 + sqrt(1 + u^2)).
        let half = one / (one + (one + squared_tangent).sqrt());
        let far = (squared_tangent * half * half).polynomial(&ARCTANGENT) * inverse * half * 8.0;
        ratio = near.select(ratio, far);
        let bent = (one - ratio * w * 0.5) / (ratio * ratio * squared_sine);
        curvature = near.select(curvature, bent);
    }
    let turned = ratio * sign;
    let rotation = [x * turned, y * turned, z * turned];
    // V^-1 t = t - r x t / 2 + (1 - (a/2) cot(a/2)) / a^2 r x (r x t).
    let once = cross(rotation, translation);
    let twice = cross(rotation, once);
    let mut straight = translation;
    for axis in 0..3 {
        straight[axis] = translation[axis] - once[axis] * 0.5 + twice[axis] * curvature;
    }
    (straight, rotation)
}

#[inline(always)]
fn cross<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector6;
    use posecut_geometry::lanes::Wide;
    use posecut_geometry::{LieGroup as _, SE3};
    use proptest::prelude::*;
    use pulp::Scalar;

    fn log(motion: &SE3) -> Vector6<f64> {
        let simd = Scalar::new();
        let lane = |value: f64| Lanes::splat(simd, value);
        let (t, q) = (motion.translation, motion.rotation.quaternion());
        let (translation, rotation) =
            logarithm(simd, [t.x, t.y, t.z].map(lane), [q.w, q.i, q.j, q.k].map(lane), 1);
        let mut log = Vector6::zeros();
        for axis in 0..3 {
            let mut wide = Wide::default();
            translation[axis].store(&mut wide, 0);
            log[axis] = wide.0[0];
            rotation[axis].store(&mut wide, 0);
            log[3 + axis] = wide.0[0];
        }
        log
    }

    fn compare(translation: [f64; 3], axis: [f64; 3], angle: f64, turned_round: bool) {
        let rotation = nalgebra::Vector3::from(axis).normalize() * angle;
        let [tx, ty, tz] = translation;
        let mut motion = SE3::exp(&Vector6::new(tx, ty, tz, rotation.x, rotation.y, rotation.z));
        if turned_round {
            motion.rotation = nalgebra::UnitQuaternion::new_unchecked(-motion.rotation.into_inner());
        }
        let (lanes, single) = (log(&motion), motion.log());
        let size = 1.0 + motion.translation.norm();
        assert!((lanes - single).norm() < 1e-14 * size, "{lanes} {single}");
    }

    proptest! {
        #[test]
        fn it_is_that_of_the_geometry_for_small_and_large_turns(
            translation in proptest::array::uniform3(-100.0_f64..100.0),
            axis in proptest::array::uniform3(0.1_f64..1.0),
            exponent in -12.0_f64..0.49,
            turned_round in any::<bool>(),
        ) {
            compare(translation, axis, 10_f64.powf(exponent), turned_round);
        }
    }

    #[test]
    fn it_keeps_its_digits_where_series_end_and_near_pi() {
        let pi = std::f64::consts::PI;
        for angle in [0.0, 1.0 - 1e-12, 1.0 + 1e-12, 2.0, pi - 1e-3, pi - 1e-9] {
            compare([1.0, -2.0, 3.0], [0.3, 0.5, -0.8], angle, false);
        }
    }
}

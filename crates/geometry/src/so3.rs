//! Rotations of space: the operations of SO(3) that SE(3) uses.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use crate::trigonometric::{Trigonometric, half_cotangent};

/// The cross product as a matrix: `hat(a) b = a x b`.
#[inline(always)]
pub(crate) fn hat(vector: &Vector3<f64>) -> Matrix3<f64> {
    let [x, y, z] = [vector.x, vector.y, vector.z];
    Matrix3::new(0.0, -z, y, z, 0.0, -x, -y, x, 0.0)
}

/// The rotation about the axis `rotation` by its length `a` (radians): `q = (cos(a/2), sin(a/2)/a * rotation)`.
#[inline(always)]
pub(crate) fn exp(rotation: &Vector3<f64>) -> UnitQuaternion<f64> {
    let angle = rotation.norm();
    let (sine, cosine) = (0.5 * angle).sin_cos();
    // sin(a/2)/a is exact to rounding for every representable a > 0; only 0/0 needs another value.
    let scale = if angle > 0.0 { sine / angle } else { 0.5 };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cosine, rotation * scale))
}

/// The rotation vector, of length at most pi.
///
/// Computed from the quaternion by `2 atan2(|v|, w)`, which keeps all digits at pi; the trace of the matrix has none there.
#[inline(always)]
pub(crate) fn log(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    // q and -q are the same rotation; w >= 0 is the shorter one.
    let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    let vector = rotation.imag() * sign;
    let scalar = rotation.w * sign;
    let sine = vector.norm();
    if sine > 0.0 { vector * (2.0 * sine.atan2(scalar) / sine) } else { vector * 2.0 }
}

/// `V = I + c_2 [r] + c_3 [r]^2`, Solà equation (145).
#[inline(always)]
pub(crate) fn left_jacobian(rotation: &Vector3<f64>) -> Matrix3<f64> {
    let functions = Trigonometric::of_squared_angle(rotation.norm_squared());
    let cross = hat(rotation);
    Matrix3::identity() + cross * functions.c2 + cross * cross * functions.c3
}

/// `V^-1 = I - [r]/2 + (1 - (a/2) cot(a/2)) / a^2 [r]^2`, Solà equation (146).
#[inline(always)]
pub(crate) fn left_jacobian_inverse(rotation: &Vector3<f64>) -> Matrix3<f64> {
    left_jacobian_inverse_with(rotation, half_cotangent(rotation.norm_squared()))
}

/// [`left_jacobian_inverse`] with the factor of `[r]^2`.
#[inline(always)]
pub(crate) fn left_jacobian_inverse_with(rotation: &Vector3<f64>, factor: f64) -> Matrix3<f64> {
    let cross = hat(rotation);
    Matrix3::identity() - cross * 0.5 + cross * cross * factor
}

//! Rigid motions of space.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::{Matrix3, Matrix6, Quaternion, UnitQuaternion, Vector3, Vector6};

use crate::lie_group::LieGroup;
use crate::se2::SE2;
use crate::so3;
use crate::trigonometric::{Trigonometric, half_cotangent, half_cotangent_slope};

/// A quaternion whose norm differs from 1 by more than this is not a rotation.
const NORM_TOLERANCE: f64 = 1e-3;

/// A pose in space: translation in metres, rotation as a unit quaternion. Tangent order `[x, y, z, rx, ry, rz]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SE3 {
    /// Position of the frame's origin, metres.
    pub translation: Vector3<f64>,
    /// Orientation of the frame.
    pub rotation: UnitQuaternion<f64>,
}

impl SE3 {
    /// The pose with this position (metres) and orientation.
    pub fn new(translation: Vector3<f64>, rotation: UnitQuaternion<f64>) -> Self {
        Self { translation, rotation }
    }

    /// The pose at `(x, y, z)` metres with `R = Rz(yaw) Ry(pitch) Rx(roll)`, radians.
    pub fn from_euler(x: f64, y: f64, z: f64, roll: f64, pitch: f64, yaw: f64) -> Self {
        Self::new(Vector3::new(x, y, z), UnitQuaternion::from_euler_angles(roll, pitch, yaw))
    }

    /// `(roll, pitch, yaw)` in radians with `R = Rz(yaw) Ry(pitch) Rx(roll)`; pitch in `[-pi/2, pi/2]`.
    ///
    /// At a pitch of +-pi/2 only the sum or difference of roll and yaw is defined; roll is 0 there.
    pub fn euler(&self) -> (f64, f64, f64) {
        let matrix = self.rotation.to_rotation_matrix().into_inner();
        // atan2 of the column's entries keeps the digits near +-pi/2 that asin loses.
        let cosine = matrix.m11.hypot(matrix.m21);
        let pitch = (-matrix.m31).atan2(cosine);
        if cosine < 1e-12 {
            return (0.0, pitch, (-matrix.m12).atan2(matrix.m22));
        }
        (matrix.m32.atan2(matrix.m33), pitch, matrix.m21.atan2(matrix.m11))
    }

    /// The pose projected to the plane: `(x, y, yaw)`; z, roll and pitch are lost.
    pub fn to_planar(&self) -> SE2 {
        let (_, _, yaw) = self.euler();
        SE2::new(self.translation.x, self.translation.y, yaw)
    }
}

/// The matrix `[diagonal, upper; 0, diagonal]`.
#[inline(always)]
fn triangular(diagonal: &Matrix3<f64>, upper: &Matrix3<f64>) -> Matrix6<f64> {
    let mut matrix = Matrix6::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(diagonal);
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(upper);
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(diagonal);
    matrix
}

/// Translation and rotation of a tangent vector.
#[inline(always)]
fn split(tangent: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(tangent[0], tangent[1], tangent[2]), Vector3::new(tangent[3], tangent[4], tangent[5]))
}

/// `Q`, the upper right block of the left Jacobian. Solà equation (180), after Barfoot and Furgale, "Associating
/// uncertainty with three-dimensional poses for use in estimation problems", 2014, equation (102).
///
/// With P = `[translation]` and R = `[rotation]`:
/// `P/2 + c_3 (RP + PR + RPR) + c_4 (RRP + PRR - 3 RPR) + (c_4 - 3 c_5)/2 (RPRR + RRPR)`.
#[inline(always)]
fn coupling(translation: &Vector3<f64>, rotation: &Vector3<f64>) -> Matrix3<f64> {
    let functions = Trigonometric::of_squared_angle(rotation.norm_squared());
    let p = so3::hat(translation);
    let r = so3::hat(rotation);
    let rp = r * p;
    let pr = p * r;
    let rpr = rp * r;
    p * 0.5
        + (rp + pr + rpr) * functions.c3
        + (r * rp + pr * r - rpr * 3.0) * functions.c4
        + (rpr * r + r * rpr) * (0.5 * (functions.c4 - 3.0 * functions.c5))
}

impl LieGroup<6> for SE3 {
    const COMPONENTS: usize = 7;

    fn identity() -> Self {
        Self::new(Vector3::zeros(), UnitQuaternion::identity())
    }

    fn from_components(components: &[f64]) -> Option<Self> {
        let &[x, y, z, qx, qy, qz, qw] = components else { return None };
        if components.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let quaternion = Quaternion::new(qw, qx, qy, qz);
        let squared = quaternion.norm_squared();
        if (squared.sqrt() - 1.0).abs() > NORM_TOLERANCE {
            return None;
        }
        // A quaternion of norm 1 up to rounding keeps its bits, so that reading and writing is idempotent.
        let rotation = if (squared - 1.0).abs() <= 8.0 * f64::EPSILON {
            UnitQuaternion::new_unchecked(quaternion)
        } else {
            UnitQuaternion::new_normalize(quaternion)
        };
        Some(Self::new(Vector3::new(x, y, z), rotation))
    }

    fn components(&self) -> Vec<f64> {
        let (t, q) = (&self.translation, &self.rotation);
        vec![t.x, t.y, t.z, q.i, q.j, q.k, q.w]
    }

    #[inline(always)]
    fn exp(tangent: &Vector6<f64>) -> Self {
        let (translation, rotation) = split(tangent);
        Self::new(so3::left_jacobian(&rotation) * translation, so3::exp(&rotation))
    }

    #[inline(always)]
    fn log(&self) -> Vector6<f64> {
        let rotation = so3::log(&self.rotation);
        let translation = so3::left_jacobian_inverse(&rotation) * self.translation;
        Vector6::new(translation.x, translation.y, translation.z, rotation.x, rotation.y, rotation.z)
    }

    #[inline(always)]
    fn compose(&self, other: &Self) -> Self {
        let mut rotation = self.rotation * other.rotation;
        // One Newton step towards norm 1; otherwise long chains would drift away from rotations.
        rotation.renormalize_fast();
        Self::new(self.translation + self.rotation * other.translation, rotation)
    }

    #[inline(always)]
    fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        Self::new(-(rotation * self.translation), rotation)
    }

    /// `[R, [t] R; 0, R]`, Solà equation (175).
    #[inline(always)]
    fn adjoint(&self) -> Matrix6<f64> {
        let rotation = self.rotation.to_rotation_matrix().into_inner();
        triangular(&rotation, &(so3::hat(&self.translation) * rotation))
    }

    /// `[[rotation], [translation]; 0, [rotation]]` of cross products.
    #[inline(always)]
    fn bracket(tangent: &Vector6<f64>) -> Matrix6<f64> {
        let (translation, rotation) = split(tangent);
        triangular(&so3::hat(&rotation), &so3::hat(&translation))
    }

    /// `[V, Q; 0, V]`, Solà equation (179).
    fn left_jacobian(tangent: &Vector6<f64>) -> Matrix6<f64> {
        let (translation, rotation) = split(tangent);
        triangular(&so3::left_jacobian(&rotation), &coupling(&translation, &rotation))
    }

    /// `[V^-1, -V^-1 Q V^-1; 0, V^-1]`, Solà equation (182).
    #[inline(always)]
    fn left_jacobian_inverse(tangent: &Vector6<f64>) -> Matrix6<f64> {
        let (translation, rotation) = split(tangent);
        let inverse = so3::left_jacobian_inverse(&rotation);
        triangular(&inverse, &-(inverse * coupling(&translation, &rotation) * inverse))
    }

    /// The diagonal block is `f([r]) = I + [r]/2 + h [r]^2`, and the upper right block its derivative in the direction `[p]`:
    /// `[p]/2 + h ([r][p] + [p][r]) + 2 h' (r . p) [r]^2`, with `h(a^2) = (1 - (a/2) cot(a/2)) / a^2`. Products of cross products are
    /// dyads: `[r][p] = p r^T - (r . p) I`.
    #[inline(always)]
    fn log_with_jacobian(&self) -> (Vector6<f64>, Matrix6<f64>) {
        let rotation = so3::log(&self.rotation);
        let squared = rotation.norm_squared();
        let (h, slope) = (half_cotangent(squared), half_cotangent_slope(squared));
        let p = so3::left_jacobian_inverse_with(&rotation, h) * self.translation;
        let (hat_r, hat_p) = (so3::hat(&rotation), so3::hat(&p));
        let along = rotation.dot(&p);
        let dyad = rotation * rotation.transpose();
        let mixed = p * rotation.transpose();
        let square = dyad - Matrix3::identity() * squared;
        let diagonal = Matrix3::identity() + hat_r * 0.5 + square * h;
        let upper = hat_p * 0.5
            + (mixed + mixed.transpose() - Matrix3::identity() * (2.0 * along)) * h
            + square * (2.0 * slope * along);
        let tangent = Vector6::new(p.x, p.y, p.z, rotation.x, rotation.y, rotation.z);
        (tangent, triangular(&diagonal, &upper))
    }

    fn translation(&self) -> [f64; 3] {
        [self.translation.x, self.translation.y, self.translation.z]
    }

    fn rotation_angle(&self) -> f64 {
        2.0 * self.rotation.imag().norm().atan2(self.rotation.w.abs())
    }
}

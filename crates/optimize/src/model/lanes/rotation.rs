//! Rotations of space, one in each lane.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::Simd;

use super::vector::{Matrix, Vector, cross, dot, negated, plus, scaled_plus};
use posecut_geometry::lanes::Lanes;

/// A rotation as a unit quaternion.
#[derive(Clone, Copy)]
pub(super) struct Rotation<S: Simd> {
    pub(super) scalar: Lanes<S>,
    pub(super) vector: Vector<S>,
}

impl<S: Simd> Rotation<S> {
    /// `R^T a = a - w c + v x c` with `c = 2 v x a`.
    #[inline(always)]
    pub(super) fn back(self, a: Vector<S>) -> Vector<S> {
        let half = cross(self.vector, a);
        let turned = plus(half, half);
        plus(scaled_plus(turned, -self.scalar, a), cross(self.vector, turned))
    }

    /// `other` in this frame: `q^-1 other`.
    #[inline(always)]
    pub(super) fn between(self, other: Self) -> Self {
        let vector = cross(other.vector, self.vector);
        let vector = scaled_plus(other.vector, self.scalar, vector);
        Self {
            scalar: self.scalar.times_plus(other.scalar, dot(self.vector, other.vector)),
            vector: scaled_plus(self.vector, -other.scalar, vector),
        }
    }

    /// `q^-1`.
    #[inline(always)]
    pub(super) fn inverse(self) -> Self {
        Self { vector: negated(self.vector), ..self }
    }

    /// The matrix `R`.
    #[inline(always)]
    pub(super) fn matrix(self) -> Matrix<S> {
        let Self { scalar: w, vector: [x, y, z] } = self;
        let one = w.constant(1.0);
        let [x2, y2, z2] = [x + x, y + y, z + z];
        let (xx, yy, zz) = (x * x2, y * y2, z * z2);
        let (xy, xz, yz) = (x * y2, x * z2, y * z2);
        [
            [one - (yy + zz), w.times_plus(z2, xy), w.times_from(y2, xz)],
            [w.times_from(z2, xy), one - (xx + zz), w.times_plus(x2, yz)],
            [w.times_plus(y2, xz), w.times_from(x2, yz), one - (xx + yy)],
        ]
    }
}

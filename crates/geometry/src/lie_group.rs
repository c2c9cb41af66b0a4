//! The operations that SE(2) and SE(3) share.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use nalgebra::{SMatrix, SVector};

/// The number of translation components in a tangent vector of so many degrees of freedom, 3 or 6. They come first.
pub const fn translations(degrees_of_freedom: usize) -> usize {
    if degrees_of_freedom == 6 { 3 } else { 2 }
}

/// A group of rigid motions with `DOF` degrees of freedom: 3 for [`SE2`](crate::SE2), 6 for [`SE3`](crate::SE3).
///
/// Notation and Jacobians follow J. Solà, J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics",
/// 2018; equation numbers below refer to this paper.
pub trait LieGroup<const DOF: usize>:
    Copy + Clone + std::fmt::Debug + PartialEq + Send + Sync + 'static
{
    /// Number of stored components: 3, `[x, y, theta]`, or 7, `[x, y, z, qx, qy, qz, qw]`.
    const COMPONENTS: usize;

    /// The identity.
    fn identity() -> Self;

    /// Reads stored components (metres, radians or quaternion).
    ///
    /// `None` if there are not [`COMPONENTS`](Self::COMPONENTS) of them, if one is not finite, or if the norm of the
    /// quaternion differs from 1 by more than 1e-3. Otherwise the quaternion is normalised.
    fn from_components(components: &[f64]) -> Option<Self>;

    /// The stored components; theta is in `(-pi, pi]`.
    fn components(&self) -> Vec<f64>;

    /// Exponential of a tangent vector (translation, rotation).
    fn exp(tangent: &SVector<f64, DOF>) -> Self;

    /// Logarithm: the shortest tangent vector with `exp(log(T)) = T`; its rotation is at most pi.
    fn log(&self) -> SVector<f64, DOF>;

    /// The product `self * other`.
    #[must_use]
    fn compose(&self, other: &Self) -> Self;

    /// The inverse motion.
    #[must_use]
    fn inverse(&self) -> Self;

    /// The relative pose `self^-1 * other`: `other` in the frame of `self`.
    #[must_use]
    #[inline(always)]
    fn between(&self, other: &Self) -> Self {
        self.inverse().compose(other)
    }

    /// Adjoint: `T Exp(xi) = Exp(Ad(T) xi) T`. Equation (30).
    fn adjoint(&self) -> SMatrix<f64, DOF, DOF>;

    /// The adjoint `ad(xi)` of the algebra: `ad(xi) eta = [xi, eta]`, the derivative of `Ad(Exp(t xi)) eta` by `t` at zero.
    fn bracket(tangent: &SVector<f64, DOF>) -> SMatrix<f64, DOF, DOF>;

    /// Left Jacobian: `Exp(xi + d) = Exp(J_l(xi) d) Exp(xi)` to first order in `d`. Equation (44).
    fn left_jacobian(tangent: &SVector<f64, DOF>) -> SMatrix<f64, DOF, DOF>;

    /// Inverse of the left Jacobian; exists while the rotation is shorter than two pi.
    fn left_jacobian_inverse(tangent: &SVector<f64, DOF>) -> SMatrix<f64, DOF, DOF>;

    /// Right Jacobian: `Exp(xi + d) = Exp(xi) Exp(J_r(xi) d)` to first order in `d`. Equations (41) and (75):
    /// `J_r(xi) = J_l(-xi)`.
    #[inline(always)]
    fn right_jacobian(tangent: &SVector<f64, DOF>) -> SMatrix<f64, DOF, DOF> {
        Self::left_jacobian(&-tangent)
    }

    /// Inverse of the right Jacobian: `Log(T Exp(d)) = Log(T) + J_r^-1(Log(T)) d` to first order in `d`.
    #[inline(always)]
    fn right_jacobian_inverse(tangent: &SVector<f64, DOF>) -> SMatrix<f64, DOF, DOF> {
        Self::left_jacobian_inverse(&-tangent)
    }

    /// [`log`](Self::log), to the bit, and [`right_jacobian_inverse`](Self::right_jacobian_inverse) there, up to rounding: for less than
    /// both cost apart.
    #[inline(always)]
    fn log_with_jacobian(&self) -> (SVector<f64, DOF>, SMatrix<f64, DOF, DOF>) {
        let tangent = self.log();
        (tangent, Self::right_jacobian_inverse(&tangent))
    }

    /// Translation in metres; z is 0 in the plane.
    fn translation(&self) -> [f64; 3];

    /// Magnitude of the rotation, in `[0, pi]` radians.
    fn rotation_angle(&self) -> f64;

    /// The pose a fraction of the way to `other` on the geodesic: `self * Exp(fraction * Log(self^-1 * other))`.
    ///
    /// A fraction outside `[0, 1]` extrapolates.
    #[must_use]
    fn interpolate(&self, other: &Self, fraction: f64) -> Self {
        self.compose(&Self::exp(&(self.between(other).log() * fraction)))
    }
}

//! Cheap upper bounds on a covariance at a point.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3};
use posecut_geometry::{LieGroup, SE2, SE3};

/// A group of motions that can be embedded in the motions of space.
pub trait Spatial<const DOF: usize>: LieGroup<DOF> {
    /// The index of each tangent axis among x, y, z, rx, ry, rz.
    const AXES: [usize; DOF];

    /// This motion as a motion of space.
    fn spatial(&self) -> SE3;
}

impl Spatial<3> for SE2 {
    const AXES: [usize; 3] = [0, 1, 5];

    fn spatial(&self) -> SE3 {
        self.to_spatial()
    }
}

impl Spatial<6> for SE3 {
    const AXES: [usize; 6] = [0, 1, 2, 3, 4, 5];

    fn spatial(&self) -> SE3 {
        *self
    }
}

/// The terms that bounds need of the covariance of a small motion (rho, omega), in some frame.
///
/// A point q of the frame moves by rho + omega x q. The trace of its covariance is
///
/// tr S_rho + 2 q . c + q^T (tr S_omega I - S_omega) q,  c = sum over axes of e x Cov(omega, rho).
///
/// This bounds the largest eigenvalue of the translation's covariance at q. All terms are linear in the covariance, so the
/// terms of a stretch of odometry are differences of accumulated ones.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Spread {
    pub(crate) translation: f64,
    pub(crate) lever: [f64; 3],
    /// tr S_omega I - S_omega: xx, yy, zz, xy, xz, yz.
    pub(crate) rotation: [f64; 6],
    /// A bound on the largest eigenvalue of S_omega. Along a stretch, bounds add up.
    pub(crate) turn: f64,
}

impl Spread {
    /// The terms of a covariance; `turn` is the largest eigenvalue of its rotation, or a bound on it.
    pub(crate) fn of<G: Spatial<DOF>, const DOF: usize>(
        covariance: &SMatrix<f64, DOF, DOF>,
        turn: f64,
    ) -> Self {
        let whole = embedded::<G, DOF>(covariance);
        let omega: Matrix3<f64> = whole.fixed_view::<3, 3>(3, 3).into_owned();
        // The expectation of omega x q . rho is q . (rho x omega).
        let cross = |row: usize, column: usize| whole[(row, 3 + column)] - whole[(column, 3 + row)];
        let trace = omega.trace();
        Self {
            translation: whole.fixed_view::<3, 3>(0, 0).trace(),
            lever: [cross(1, 2), cross(2, 0), cross(0, 1)],
            rotation: [
                trace - omega.m11,
                trace - omega.m22,
                trace - omega.m33,
                -omega.m12,
                -omega.m13,
                -omega.m23,
            ],
            turn,
        }
    }

    /// The trace of the translation's covariance at a point.
    #[inline(always)]
    pub(crate) fn at(&self, q: &Vector3<f64>) -> f64 {
        let [xx, yy, zz, xy, xz, yz] = self.rotation;
        self.translation
            + 2.0 * (q.x * self.lever[0] + q.y * self.lever[1] + q.z * self.lever[2])
            + q.x * (q.x * xx + 2.0 * (q.y * xy + q.z * xz))
            + q.y * (q.y * yy + 2.0 * q.z * yz)
            + q.z * q.z * zz
    }
}

fn embedded<G: Spatial<DOF>, const DOF: usize>(covariance: &SMatrix<f64, DOF, DOF>) -> Matrix6<f64> {
    let mut whole = Matrix6::zeros();
    for row in 0..DOF {
        for column in 0..DOF {
            whole[(G::AXES[row], G::AXES[column])] = covariance[(row, column)];
        }
    }
    whole
}

/// The largest eigenvalue of the rotation's covariance.
pub(crate) fn largest_turn<G: Spatial<DOF>, const DOF: usize>(covariance: &SMatrix<f64, DOF, DOF>) -> f64 {
    if DOF == 3 {
        return covariance[(DOF - 1, DOF - 1)];
    }
    let omega: Matrix3<f64> = embedded::<G, DOF>(covariance).fixed_view::<3, 3>(3, 3).into_owned();
    omega.symmetric_eigenvalues().max()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_spread_at_a_point_is_the_trace_of_the_covariance_there(
            entries in proptest::collection::vec(-1.0_f64..1.0, 36),
            point in proptest::array::uniform3(-10.0_f64..10.0),
        ) {
            let root = Matrix6::from_row_slice(&entries);
            let covariance = root * root.transpose();
            let point = Vector3::from(point);
            // The motion seen at q: conjugation by the translation to q.
            let there = SE3::new(point, nalgebra::UnitQuaternion::identity()).inverse().adjoint();
            let moved = there * covariance * there.transpose();
            let expected = moved.fixed_view::<3, 3>(0, 0).trace();
            let spread = Spread::of::<SE3, 6>(&covariance, 0.0);
            prop_assert!((spread.at(&point) - expected).abs() < 1e-9 * expected.abs().max(1.0));
            let plane = covariance.fixed_view::<3, 3>(0, 0).into_owned();
            let there = SE2::new(point.x, point.y, 0.0).inverse().adjoint();
            let moved = there * plane * there.transpose();
            let expected = moved[(0, 0)] + moved[(1, 1)];
            let spread = Spread::of::<SE2, 3>(&plane, 0.0).at(&Vector3::new(point.x, point.y, 0.0));
            prop_assert!((spread - expected).abs() < 1e-9 * expected.abs().max(1.0));
        }
    }
}

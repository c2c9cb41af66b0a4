//! Squared Mahalanobis distances of a register's lanes.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]
#![allow(
    clippy::needless_range_loop,
    reason = "formulas over rows, columns and terms of several matrices at once"
)]

use pulp::Simd;

use posecut_geometry::lanes::Lanes;

/// As [`crate::odometry::chain::squared_mahalanobis`]; NaN if the covariance is not positive definite.
#[inline(always)]
pub(super) fn squared_mahalanobis<S: Simd, const DOF: usize>(
    simd: S,
    covariance: &mut [[Lanes<S>; DOF]; DOF],
    error: &mut [Lanes<S>; DOF],
) -> Lanes<S> {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let mut definite = zero.less_than(covariance[0][0]);
    let mut sum = zero;
    for column in 0..DOF {
        let pivot = covariance[column][column];
        definite = definite.and(zero.less_than(pivot));
        let inverse = one / pivot;
        sum = sum + error[column] * error[column] * inverse;
        for later in column + 1..DOF {
            let ratio = covariance[later][column] * inverse;
            error[later] = error[later] - ratio * error[column];
            for last in later..DOF {
                covariance[last][later] = covariance[last][later] - ratio * covariance[last][column];
            }
        }
    }
    definite.select(sum, Lanes::splat(simd, f64::NAN))
}

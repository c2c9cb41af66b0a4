//! Moves a start rigidly to the priors.
//!
//! Odometry and closures give a start only up to a rigid motion `T`. For weights `w_i` of measured positions `z_i` and `k_i` of
//! measured rotations `S_i`, the minimum of `sum w_i |Q x_i + s - z_i|^2 + sum k_i |Q R_i - S_i|^2` over `T = (Q, s)` is the
//! rotation nearest to `sum w_i (z_i - z)(x_i - x)^T + sum k_i S_i R_i^T` with the weighted means `z` and `x`, and
//! `s = z - Q x` (S. Umeyama, "Least-squares estimation of transformation parameters between two point patterns", IEEE PAMI
//! 13(4), 1991, equations 40 and 41, without scale; rotations are further columns of the same problem).
//!
//! Gross outliers spoil that minimum, so a second proposal reweights: least absolute residuals, by the weights
//! `1 / max(|e_i|, 1)` of whitened residuals (Weiszfeld). Both are refined for the real cost of the priors, with full
//! information matrices and robust kernels, by damped Gauss-Newton steps over `T`; the cheaper one is taken. Less than half of
//! the priors may be outliers: of two rigid groups of equal weight, the start follows either.

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;
use posecut_graph::PriorOf;

use super::chordal::MatrixPose;
use crate::model::prior::Prior;

/// Number of reweighted minima. The weights settle to some per cent, which the refinement makes exact.
const REWEIGHTINGS: usize = 30;
/// Number of steps of the refinement: it only chooses a start.
const STEPS: usize = 20;
/// Share of the moments' norm that is added to their diagonal: if priors leave rotations free, the smallest of those that
/// minimise the cost is taken.
const TIE: f64 = 1e-9;

/// The rigid motion that moves poses to their priors: `T X_i` instead of `X_i`.
pub(crate) fn aligning<G, const DOF: usize, const N: usize>(priors: &[Prior<G, DOF>], poses: &[G]) -> G
where
    G: LieGroup<DOF> + MatrixPose<N>,
{
    let plain: Vec<f64> = vec![1.0; priors.len()];
    let squares: G = least_squares(priors, poses, &plain);
    let mut absolute = squares;
    for _ in 0..REWEIGHTINGS {
        let weight = |prior: &Prior<G, DOF>| {
            1.0 / prior.squared(&absolute.compose(&poses[prior.node])).sqrt().max(1.0)
        };
        let weights: Vec<f64> = priors.iter().map(weight).collect();
        absolute = least_squares(priors, poses, &weights);
    }
    let (squares, cost) = refined(priors, poses, squares);
    let (absolute, other) = refined(priors, poses, absolute);
    if other < cost { absolute } else { squares }
}

/// The closed form.
fn least_squares<G, const DOF: usize, const N: usize>(
    priors: &[Prior<G, DOF>],
    poses: &[G],
    weights: &[f64],
) -> G
where
    G: LieGroup<DOF> + MatrixPose<N>,
{
    let mean = |information: &SMatrix<f64, DOF, DOF>, axes: std::ops::Range<usize>| {
        let count = axes.len() as f64;
        axes.map(|axis| information[(axis, axis)]).sum::<f64>() / count
    };
    let mut total = 0.0;
    let (mut from, mut to) = (SVector::<f64, N>::zeros(), SVector::<f64, N>::zeros());
    for (prior, share) in priors.iter().zip(weights) {
        let weight = share * mean(&prior.information, 0..N);
        total += weight;
        from += poses[prior.node].translation_vector() * weight;
        to += prior.measurement.translation_vector() * weight;
    }
    if total > 0.0 {
        from /= total;
        to /= total;
    }
    let mut moments = SMatrix::<f64, N, N>::zeros();
    for (prior, share) in priors.iter().zip(weights) {
        let weight = share * mean(&prior.information, 0..N);
        let pose = &poses[prior.node];
        let (x, z) = (pose.translation_vector() - from, prior.measurement.translation_vector() - to);
        moments += z * x.transpose() * weight;
        if prior.of == PriorOf::Pose {
            let turn = share * mean(&prior.information, N..DOF);
            moments += prior.measurement.rotation_matrix() * pose.rotation_matrix().transpose() * turn;
        }
    }
    let size = moments.norm();
    let tie = if size > 0.0 { TIE * size } else { 1.0 };
    let rotation = G::nearest_rotation(&(moments + SMatrix::identity() * tie));
    // Without any information about positions the motion only turns.
    let shift = if total > 0.0 { to - rotation * from } else { SVector::zeros() };
    G::from_matrix(&rotation, &shift)
}

/// Damped Gauss-Newton steps over the motion, and the cost of the result. With `T Exp(d) X = T X Exp(Ad(X^-1) d)` the equations
/// of all priors are sums of their models at `T X`.
fn refined<G: LieGroup<DOF>, const DOF: usize>(priors: &[Prior<G, DOF>], poses: &[G], start: G) -> (G, f64) {
    let cost = |motion: &G| {
        priors.iter().map(|prior| prior.charge(&motion.compose(&poses[prior.node])).0).sum::<f64>()
    };
    let (mut motion, mut damping) = (start, 1e-6);
    let mut lowest = cost(&motion);
    for _ in 0..STEPS {
        let (mut matrix, mut gradient) = (SMatrix::<f64, DOF, DOF>::zeros(), SVector::<f64, DOF>::zeros());
        for prior in priors {
            let pose = &poses[prior.node];
            let model = prior.linearise(&motion.compose(pose));
            let adjoint = pose.inverse().adjoint();
            matrix += adjoint.tr_mul(&model.block) * adjoint;
            gradient += adjoint.tr_mul(&model.gradient);
        }
        let floor = 1e-12 * matrix.diagonal().amax();
        for axis in 0..DOF {
            let entry = matrix[(axis, axis)];
            matrix[(axis, axis)] += (damping * entry).max(floor);
        }
        let Some(step) = matrix.cholesky().map(|factor| -factor.solve(&gradient)) else { break };
        let trial = motion.compose(&G::exp(&step));
        let found = cost(&trial);
        if found < lowest {
            (motion, lowest) = (trial, found);
            damping *= 0.1;
        } else {
            damping *= 100.0;
        }
    }
    (motion, lowest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Matrix6, Vector6};
    use posecut_geometry::{SE2, SE3};

    /// Poses on a curve, and their true motion.
    fn curve() -> (Vec<SE3>, SE3) {
        let pose = |at: u32| {
            let t = f64::from(at) * 0.3;
            SE3::from_euler(3.0 * t, 4.0 * t.sin(), t.cos() + 0.1 * t * t, 0.1 * t, -0.05 * t, t)
        };
        ((0..12).map(pose).collect(), SE3::from_euler(100.0, -50.0, 3.0, 0.4, -0.7, 2.5))
    }

    fn position(node: usize, at: &SE3) -> Prior<SE3, 6> {
        Prior::position(node, *at, Matrix6::from_diagonal(&Vector6::new(4.0, 4.0, 1.0, 0.0, 0.0, 0.0)))
    }

    fn off(found: &SE3, expected: &SE3) -> f64 {
        expected.between(found).log().norm()
    }

    #[test]
    fn exact_positions_and_a_single_pose_give_the_motion() {
        let (poses, motion) = curve();
        let positions: Vec<_> =
            poses.iter().enumerate().map(|(node, pose)| position(node, &motion.compose(pose))).collect();
        assert!(off(&aligning(&positions, &poses), &motion) < 1e-9);
        let one = [Prior::pose(5, motion.compose(&poses[5]), Matrix6::identity())];
        assert!(off(&aligning(&one, &poses), &motion) < 1e-9);
        let three = [positions[0], positions[4], positions[9]];
        assert!(off(&aligning(&three, &poses), &motion) < 1e-9);
    }

    /// Under a robust kernel five outliers of twelve do not move the alignment; without one they do.
    #[test]
    fn outliers_do_not_spoil_the_start_under_a_kernel() {
        let (poses, motion) = curve();
        let mut priors: Vec<_> =
            poses.iter().enumerate().map(|(node, pose)| position(node, &motion.compose(pose))).collect();
        for (number, node) in [1, 3, 6, 8, 10].into_iter().enumerate() {
            let far = SE3::from_euler(80.0, -60.0 * number as f64, 20.0, 0.0, 0.0, 0.0);
            priors[node].measurement = far.compose(&priors[node].measurement);
        }
        assert!(off(&aligning(&priors, &poses), &motion) > 1.0);
        for prior in &mut priors {
            prior.kernel = Some(crate::Kernel::Truncated { width: 4.0, convexity: f64::INFINITY });
        }
        assert!(off(&aligning(&priors, &poses), &motion) < 1e-6);
    }

    #[test]
    fn one_position_moves_without_turning() {
        let information = Matrix3::from_diagonal(&nalgebra::Vector3::new(1.0, 1.0, 0.0));
        let priors = [Prior::position(1, SE2::new(10.0, 20.0, 0.0), information)];
        let motion = aligning::<SE2, 3, 2>(&priors, &[SE2::identity(), SE2::new(1.0, 2.0, 0.5)]);
        assert!((motion.translation - nalgebra::Vector2::new(9.0, 18.0)).norm() < 1e-12, "{motion:?}");
        assert!(motion.angle().abs() < 1e-12, "{motion:?}");
    }
}

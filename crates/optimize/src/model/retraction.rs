//! How a step moves poses.
//!
//! `X Exp(v, r)` takes a pose along a screw. Where a long common motion `v` meets a bend of `w` radians between neighbours, their relative
//! position then errs by `w v / 2`. With positions and rotations moved apart, `X (I, v) Exp(0, r)`, it errs by the square of the rotation
//! `r`, however long the motion is. On most graphs a first step then lowers the cost by more.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::{Simd, WithSimd};
use nalgebra::SVector;
use posecut_cholesky::instructions::for_small_blocks;
use posecut_geometry::{LieGroup, translations};

use super::lanes::LaneGroup;

/// `X (I, v) Exp(0, r)` for the step `(v, r)`.
pub(crate) fn moved_apart<G: LieGroup<DOF>, const DOF: usize>(pose: &G, step: &SVector<f64, DOF>) -> G {
    let (mut along, mut about) = (*step, *step);
    along.rows_range_mut(translations(DOF)..).fill(0.0);
    about.rows_range_mut(..translations(DOF)).fill(0.0);
    pose.compose(&G::exp(&along)).compose(&G::exp(&about))
}

/// Writes the poses, moved apart by each step.
pub(crate) fn retract<G: LaneGroup<DOF>, const DOF: usize>(
    poses: &[G],
    steps: &[SVector<f64, DOF>],
    moved: &mut [G],
) {
    for_small_blocks(Retract { poses, steps, moved });
}

/// Writes the poses, moved along screws by each step.
pub(crate) fn retract_by_screws<G: LieGroup<DOF>, const DOF: usize>(
    poses: &[G],
    steps: &[SVector<f64, DOF>],
    moved: &mut [G],
) {
    for ((pose, step), moved) in poses.iter().zip(steps).zip(moved) {
        *moved = pose.compose(&G::exp(step));
    }
}

/// [`retract`] for one set of vector instructions.
struct Retract<'a, G, const DOF: usize> {
    poses: &'a [G],
    steps: &'a [SVector<f64, DOF>],
    moved: &'a mut [G],
}

impl<G: LaneGroup<DOF>, const DOF: usize> WithSimd for Retract<'_, G, DOF> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { poses, steps, moved } = self;
        let lanes = S::F64_LANES;
        for ((poses, steps), moved) in
            poses.chunks(lanes).zip(steps.chunks(lanes)).zip(moved.chunks_mut(lanes))
        {
            if !G::moved(simd, poses, steps, moved) {
                for ((pose, step), moved) in poses.iter().zip(steps).zip(moved) {
                    *moved = moved_apart(pose, step);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use posecut_geometry::SE2;

    /// Two neighbours move 50 m together and bend by 0.02 rad: the edge between them should change by what the linear model says.
    #[test]
    fn a_long_common_motion_with_a_small_bend_does_not_stretch_an_edge() {
        let poses = [SE2::new(3.0, 1.0, 0.4), SE2::new(4.0, 1.2, 0.9)];
        let common = nalgebra::Vector2::new(40.0, -30.0);
        let steps: Vec<Vector3<f64>> = poses
            .iter()
            .zip([0.01, 0.03])
            .map(|(pose, turn)| {
                let own = pose.rotation.inverse() * common;
                Vector3::new(own.x, own.y, turn)
            })
            .collect();
        let before = poses[0].between(&poses[1]);
        let expected = steps[1] - before.inverse().adjoint() * steps[0];
        let error = |retract: fn(&[SE2], &[Vector3<f64>], &mut [SE2])| {
            let mut moved = poses;
            retract(&poses, &steps, &mut moved);
            (before.between(&moved[0].between(&moved[1])).log() - expected).amax()
        };
        let (apart, screw) = (error(retract), error(retract_by_screws));
        assert!(apart < 1e-3, "{apart}");
        assert!(screw > 0.3, "{screw}");
    }
}

//! What robots measure of their steps.

use nalgebra::SVector;
use posecut_geometry::{LieGroup, translations};
use posecut_random::ChaCha8Rng;
use rand::RngExt as _;

use crate::Character;
use crate::noise::{Noise, normal, tangent};

/// Deviations of a slip, metres and radians.
const SLIP: (f64, f64) = (1.0, 0.2);

/// The measured steps of one robot: white noise, a wrong scale and a wrong turn that it has all the time, and slips.
pub(crate) fn odometry<G: LieGroup<DOF>, const DOF: usize>(
    path: &[G],
    character: &Character,
    random: &mut ChaCha8Rng,
) -> Vec<G> {
    let (translation, rotation) = character.odometry_sigma;
    let ratio = character.odometry_ratio;
    let noise = Noise { sigma: (ratio * translation, ratio * rotation), heavy_tails: false };
    let scale = 1.0 + character.odometry_scale * normal(random);
    // The last axis of the tangent space is the turn about the vertical.
    let turn = character.odometry_turn * normal(random);
    let measured = |pair: &[G]| {
        let step = pair[0].between(&pair[1]).log();
        let step: SVector<f64, DOF> = SVector::from_fn(|axis, _| match axis {
            axis if axis < translations(DOF) => scale * step[axis],
            axis if axis + 1 == DOF => step[axis] + turn,
            axis => step[axis],
        });
        let mut motion = noise.applied(&G::exp(&step), random);
        if random.random::<f64>() < character.slip_rate {
            motion = motion.compose(&G::exp(&tangent::<DOF>(SLIP, random)));
        }
        motion
    };
    path.windows(2).map(measured).collect()
}

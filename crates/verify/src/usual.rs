//! The usual motion of a robot, from its motions over many stretches of the same length.

use nalgebra::{SMatrix, SVector};

use crate::model::Motion;

/// The fewest motions that determine the usual one.
const FEWEST: usize = 20;

/// Mean and covariance of motions (in the frame of their end), from their logarithms; `None` if there are too few.
pub(crate) fn usual_motion<G: Motion<DOF>, const DOF: usize>(
    motions: &[SVector<f64, DOF>],
) -> Option<(G, SMatrix<f64, DOF, DOF>)> {
    if motions.len() < FEWEST {
        return None;
    }
    let count = motions.len() as f64;
    let mean = motions.iter().sum::<SVector<f64, DOF>>() / count;
    let scatter: SMatrix<f64, DOF, DOF> =
        motions.iter().map(|motion| (motion - mean) * (motion - mean).transpose()).sum();
    Some((G::exp(&mean), scatter / count))
}

//! Errors of poses against a reference.

use nalgebra::{UnitQuaternion, Vector3};
use posecut_geometry::SE3;
use serde::Serialize;

use crate::alignment::{Alignment, Freedom};
use crate::summary::Summary;

/// A node that both graphs have.
#[derive(Clone, Debug)]
pub struct Match {
    /// The session it belongs to.
    pub session: String,
    /// The frame number, which orders the nodes of a session.
    pub frame: i64,
    /// The id of the first node of the reference's connected component.
    pub component: u64,
    /// The estimated pose.
    pub estimate: SE3,
    /// The reference's pose.
    pub reference: SE3,
}

/// Absolute errors after alignment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AbsoluteError {
    /// Distances, metres.
    pub translation_m: Option<Summary>,
    /// Angles between attitudes, radians.
    pub rotation_rad: Option<Summary>,
}

/// Errors of relative motions over a number of frames.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RelativeError {
    /// The number of frames.
    pub delta_frames: usize,
    /// In metres.
    pub translation_m: Option<Summary>,
    /// In radians.
    pub rotation_rad: Option<Summary>,
}

/// The alignment of the estimate to the reference over the given matches.
pub fn align(matches: &[&Match], freedom: Freedom) -> Alignment {
    let points = |pick: fn(&Match) -> &SE3| -> Vec<Vector3<f64>> {
        matches.iter().map(|found| pick(found).translation).collect()
    };
    Alignment::best(&points(|found| &found.estimate), &points(|found| &found.reference), freedom)
}

/// Distance (m) and angle (rad) of each match after alignment.
pub fn errors(matches: &[&Match], alignment: &Alignment) -> (Vec<f64>, Vec<f64>) {
    matches
        .iter()
        .map(|found| {
            let distance =
                (alignment.apply(&found.estimate.translation) - found.reference.translation).norm();
            // Use quaternions: between equal rotation matrices, rounding can give the arc cosine of a little more than
            // 1, which is NaN.
            let turned = UnitQuaternion::from_rotation_matrix(&alignment.rotation) * found.estimate.rotation;
            (distance, turned.angle_to(&found.reference.rotation))
        })
        .unzip()
}

/// The relative pose error over `delta` successive matches of each session:
/// E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) for the reference Q and the estimate P. It needs no alignment.
pub fn relative_error(matches: &[Match], delta: usize) -> RelativeError {
    let (mut distances, mut angles) = (Vec::new(), Vec::new());
    for pair in matches.windows(delta + 1) {
        let (first, last) = (&pair[0], &pair[delta]);
        if first.session != last.session {
            continue;
        }
        let error = posecut_geometry::LieGroup::between(
            &posecut_geometry::LieGroup::between(&first.reference, &last.reference),
            &posecut_geometry::LieGroup::between(&first.estimate, &last.estimate),
        );
        distances.push(error.translation.norm());
        angles.push(error.rotation.angle());
    }
    RelativeError {
        delta_frames: delta,
        translation_m: Summary::of(&distances),
        rotation_rad: Summary::of(&angles),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Regression test: if an estimate was equal to its reference, its rotation error was NaN, which JSON wrote as
    /// null.
    #[test]
    fn a_perfect_estimate_has_rotation_error_zero_not_nan() {
        let matches: Vec<Match> = (0..200)
            .map(|frame| {
                let angle = f64::from(frame) * 0.1 - 10.0;
                let pose = SE3::from_euler(angle, angle.cos(), 0.0, 0.3 * angle.sin(), 0.2, angle);
                Match {
                    session: String::new(),
                    frame: i64::from(frame),
                    component: 0,
                    estimate: pose,
                    reference: pose,
                }
            })
            .collect();
        let all: Vec<&Match> = matches.iter().collect();
        for freedom in [Freedom::None, Freedom::Se2, Freedom::Se3] {
            let (distances, angles) = errors(&all, &align(&all, freedom));
            assert!(distances.iter().all(|error| *error < 1e-12) && angles.iter().all(|error| *error < 1e-7));
        }
    }
}

//! Which scans become keyframes.

use nalgebra::Matrix3;
use posecut_geometry::{LieGroup, SE2};

use crate::LogOptions;
use crate::log::LoggedScan;
use crate::noise::slip_variances;

/// The motion from one keyframe to the next by odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The pose of the later keyframe in the frame of the earlier one.
    pub motion: SE2,
    /// The length of the path between them, metres.
    pub distance: f64,
    /// The sum of the absolute turns between them, radians.
    pub turning: f64,
    /// The covariance of the slips of its wheels, in the frame of the later keyframe, order x, y, theta, in m^2, m rad and rad^2.
    pub slip: Matrix3<f64>,
}

impl Step {
    /// No motion.
    pub fn none() -> Self {
        Self { motion: SE2::identity(), distance: 0.0, turning: 0.0, slip: Matrix3::zeros() }
    }

    /// This step and the small motion after it.
    #[must_use]
    pub fn then(&self, small: &SE2) -> Self {
        let back = small.inverse().adjoint();
        Self {
            motion: self.motion.compose(small),
            distance: self.distance + small.translation.norm(),
            turning: self.turning + small.angle().abs(),
            slip: back * self.slip * back.transpose() + Matrix3::from_diagonal(&slip_variances(small)),
        }
    }
}

/// The indices of the keyframes among the scans, and the steps between them. O(scans).
pub fn keyframes(scans: &[LoggedScan], options: &LogOptions) -> (Vec<usize>, Vec<Step>) {
    let (mut chosen, mut steps) = (Vec::new(), Vec::new());
    let mut step = Step::none();
    for (index, scan) in scans.iter().enumerate() {
        if index == 0 {
            chosen.push(index);
            continue;
        }
        step = step.then(&scans[index - 1].robot.between(&scan.robot));
        if step.motion.translation.norm() >= options.keyframe_distance
            || step.motion.angle().abs() >= options.keyframe_angle
        {
            chosen.push(index);
            steps.push(step);
            step = Step::none();
        }
    }
    (chosen, steps)
}

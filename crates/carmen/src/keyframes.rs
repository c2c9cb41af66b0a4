//! Which scans become keyframes.

use posecut_geometry::{LieGroup, SE2};

use crate::LogOptions;
use crate::log::LoggedScan;

/// The motion from one keyframe to the next by odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The pose of the later keyframe in the frame of the earlier one.
    pub motion: SE2,
    /// The length of the path between them, metres.
    pub distance: f64,
    /// The sum of the absolute turns between them, radians.
    pub turning: f64,
}

/// The indices of the keyframes among the scans, and the steps between them. O(scans).
pub fn keyframes(scans: &[LoggedScan], options: &LogOptions) -> (Vec<usize>, Vec<Step>) {
    let (mut chosen, mut steps) = (Vec::new(), Vec::new());
    let (mut distance, mut turning) = (0.0, 0.0);
    for (index, scan) in scans.iter().enumerate() {
        let Some(&last) = chosen.last() else {
            chosen.push(index);
            continue;
        };
        let small = scans[index - 1].robot.between(&scan.robot);
        distance += small.translation.norm();
        turning += small.angle().abs();
        let last: &LoggedScan = &scans[last];
        let motion = last.robot.between(&scan.robot);
        if motion.translation.norm() >= options.keyframe_distance
            || motion.angle().abs() >= options.keyframe_angle
        {
            chosen.push(index);
            steps.push(Step { motion, distance, turning });
            (distance, turning) = (0.0, 0.0);
        }
    }
    (chosen, steps)
}

//! The pose of the robot at each scan of a log.

use std::io::Write;

use posecut_geometry::{LieGroup, SE2};
use posecut_matching::Cloud;
use posecut_matching::laser_odometry::{Outcome, Reference, match_step};

use crate::keyframes::Step;
use crate::log::Log;
use crate::noise;
use crate::write::seconds;
use crate::{LogOptions, Session};

/// Times in microseconds and poses of all scans of a log from its first keyframe on, in the order of the lines: each by odometry from the
/// keyframe before it, with scan matching by the match with that keyframe where there is one. O(scans), with scan matching O(scans * beams).
pub fn trajectory(log: &Log, session: &Session, options: &LogOptions) -> Vec<(i64, SE2)> {
    let mut poses = Vec::with_capacity(log.scans.len());
    for (node, &first) in session.chosen.iter().enumerate() {
        let end = session.chosen.get(node + 1).copied().unwrap_or(log.scans.len());
        let start = session.graph.nodes[node].pose.as_deref().and_then(SE2::from_components);
        let start = start.unwrap_or_else(SE2::identity);
        poses.push((log.scans[first].time, start));
        let cloud = options.scan_matching.then(|| Cloud::of_scan(&log.scans[first].scan));
        let reference = cloud.as_ref().map(Reference::new);
        let mut step = Step::none();
        for index in first + 1..end {
            let scan = &log.scans[index];
            step = step.then(&log.scans[index - 1].robot.between(&scan.robot));
            let matched = reference.as_ref().map_or(Outcome::Unmatched, |reference| {
                match_step(reference, &Cloud::of_scan(&scan.scan), &noise::measured(&step))
            });
            let motion = match matched {
                Outcome::Matched { measured, .. } | Outcome::Contradicting { measured, .. } => {
                    measured.motion
                }
                Outcome::Unmatched => step.motion,
            };
            poses.push((scan.time, start.compose(&motion)));
        }
    }
    poses
}

/// Writes poses in the format of the TUM benchmark, a line `t x y z qx qy qz qw` each.
pub fn write_trajectory(poses: &[(i64, SE2)], writer: &mut dyn Write) -> std::io::Result<()> {
    for (time, pose) in poses {
        let (sine, cosine) = (0.5 * pose.angle()).sin_cos();
        let [x, y] = [pose.translation.x, pose.translation.y];
        writeln!(writer, "{} {x:.6} {y:.6} 0 0 0 {sine:.9} {cosine:.9}", seconds(*time))?;
    }
    Ok(())
}

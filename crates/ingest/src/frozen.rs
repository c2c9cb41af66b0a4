//! Removes ground truth that is frozen at either end of a file.
//!
//! Some of NCLT's ground-truth files repeat their last pose to the last digit, for 53 s on 2012-11-16, while the
//! odometry shows that the robot still drives and turns. Anything constructed or evaluated from such rows is wrong by
//! as much as the robot moved.

use posecut_geometry::LieGroup as _;

use crate::Trajectory;

/// A robot that moves further than this by odometry does not stand still: metres, radians. The odometry of a standing
/// robot drifts less.
const MOVED: (f64, f64) = (0.5, 0.1);

/// Removes repetitions of one pose at either end of the ground truth if the odometry moves meanwhile. One row of the
/// repeated pose stays: the one next to the remaining rows. Returns the number of removed rows. O(rows of the
/// repetitions), each with a search in the odometry.
pub(crate) fn remove_frozen_ends(truth: &mut Trajectory, odometry: &Trajectory) -> usize {
    let before = truth.times.len();
    let moves = |times: &[i64]| {
        let mut poses = times.iter().filter_map(|&time| odometry.at(time));
        poses.next().is_some_and(|first| {
            poses
                .map(|pose| first.between(&pose))
                .any(|motion| motion.translation.norm() > MOVED.0 || motion.rotation_angle() > MOVED.1)
        })
    };
    let same = |pair: &[posecut_geometry::SE3]| pair[0] == pair[1];
    let trailing = truth.poses.windows(2).rev().take_while(|pair| same(pair)).count();
    let kept = before - trailing;
    if trailing > 0 && moves(&truth.times[kept - 1..]) {
        truth.times.truncate(kept);
        truth.poses.truncate(kept);
    }
    let leading = truth.poses.windows(2).take_while(|pair| same(pair)).count();
    if leading > 0 && moves(&truth.times[..=leading]) {
        truth.times.drain(..leading);
        truth.poses.drain(..leading);
    }
    before - truth.times.len()
}

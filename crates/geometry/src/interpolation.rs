//! Poses between the time stamps of a track.

use crate::lie_group::LieGroup;

/// The pose of a track at a time, interpolated on the group between the stamps before and after it.
///
/// `stamps` are strictly increasing (microseconds, or any other unit that `time` shares), with one pose of `poses` for each.
/// `None` outside the track (no extrapolation), for an empty track, and if the two lengths differ. Takes O(log n).
///
/// ```
/// use posecut_geometry::{SE2, interpolation::sample};
///
/// let poses = [SE2::new(0.0, 0.0, 0.0), SE2::new(2.0, 0.0, 0.0)];
/// let halfway = sample(&[10, 20], &poses, 15).unwrap();
/// assert_eq!(halfway.translation.x, 1.0);
/// assert!(sample(&[10, 20], &poses, 21).is_none());
/// ```
pub fn sample<G: LieGroup<DOF>, const DOF: usize>(stamps: &[i64], poses: &[G], time: i64) -> Option<G> {
    if stamps.len() != poses.len() {
        return None;
    }
    let after = stamps.partition_point(|&stamp| stamp < time);
    let &upper = stamps.get(after)?;
    if upper == time {
        return poses.get(after).copied();
    }
    let before = after.checked_sub(1)?;
    let lower = *stamps.get(before)?;
    // Differences in i128: stamps near opposite limits would overflow i64, and f64 alone would lose microseconds.
    let elapsed = (i128::from(time) - i128::from(lower)) as f64;
    let period = (i128::from(upper) - i128::from(lower)) as f64;
    Some(poses.get(before)?.interpolate(poses.get(after)?, elapsed / period))
}

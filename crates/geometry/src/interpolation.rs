//! Poses between the stamps of a track.

use crate::lie_group::LieGroup;

/// The pose of a track at a time, interpolated on the group between the two stamps that enclose it.
///
/// `stamps` are strictly increasing (microseconds, or any other unit that `time` shares) and `poses` goes with them.
/// `None` outside the track, for an empty track, and if the two lengths differ: it never extrapolates.
/// Takes O(log n).
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
    // Differences in i128: stamps of opposite extremes would overflow, and f64 alone would lose microseconds.
    let elapsed = (i128::from(time) - i128::from(lower)) as f64;
    let period = (i128::from(upper) - i128::from(lower)) as f64;
    Some(poses.get(before)?.interpolate(poses.get(after)?, elapsed / period))
}

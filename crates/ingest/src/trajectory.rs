//! Poses over time.

use posecut_geometry::{LieGroup, SE3};

/// Poses at ascending times, and the gaps between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// In microseconds, strictly ascending.
    pub times: Vec<i64>,
    /// One pose for each time, world from body.
    pub poses: Vec<SE3>,
    /// Intervals (before, after) that are longer than the allowed silence of a sensor. Nothing is interpolated inside.
    pub gaps: Vec<(i64, i64)>,
}

impl Trajectory {
    /// The pose at a time, interpolated along the geodesic of SE(3) between its neighbours. `None` before the first
    /// pose, after the last, and inside a gap: nothing is extrapolated. O(log n).
    pub fn at(&self, time: i64) -> Option<SE3> {
        let after = self.times.partition_point(|&stamp| stamp < time);
        let &stamp = self.times.get(after)?;
        if stamp == time {
            return Some(self.poses[after]);
        }
        let before = after.checked_sub(1)?;
        if self.in_gap(time) {
            return None;
        }
        let fraction = (time - self.times[before]) as f64 / (stamp - self.times[before]) as f64;
        Some(self.poses[before].interpolate(&self.poses[after], fraction))
    }

    /// Multiplies the distances between poses by a factor, to correct wheels that over-read; attitudes do not change.
    /// O(n).
    pub fn scale(&mut self, factor: f64) {
        for pose in &mut self.poses {
            pose.translation *= factor;
        }
    }

    /// Whether a time lies strictly inside a gap.
    pub fn in_gap(&self, time: i64) -> bool {
        self.gaps.iter().any(|&(before, after)| before < time && time < after)
    }

    /// The length of the path in metres.
    pub fn path_length(&self) -> f64 {
        self.poses.windows(2).map(|pair| (pair[1].translation - pair[0].translation).norm()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trajectory() -> Trajectory {
        Trajectory {
            times: vec![0, 10, 20, 100],
            poses: [0.0, 1.0, 2.0, 10.0].map(|x| SE3::from_euler(x, 0.0, 0.0, 0.0, 0.0, x * 0.1)).to_vec(),
            gaps: vec![(20, 100)],
        }
    }

    #[test]
    fn stamps_are_hit_exactly_and_times_between_lie_between() {
        let trajectory = trajectory();
        assert_eq!(trajectory.at(10), Some(trajectory.poses[1]));
        let middle = trajectory.at(5).unwrap().to_planar();
        assert!((middle.angle() - 0.05).abs() < 1e-12, "the rotation turns evenly");
        assert!((middle.translation.x - 0.5).abs() < 1e-3);
    }

    #[test]
    fn a_scale_lengthens_every_step_and_turns_none() {
        let known = trajectory();
        let mut scaled = known.clone();
        scaled.scale(1.07);
        for (before, after) in known.poses.windows(2).zip(scaled.poses.windows(2)) {
            let (step, longer) = (before[0].between(&before[1]), after[0].between(&after[1]));
            assert!((longer.translation - step.translation * 1.07).norm() < 1e-12);
            assert_eq!(longer.rotation, step.rotation);
        }
        assert!((scaled.path_length() - 1.07 * known.path_length()).abs() < 1e-9);
    }

    #[test]
    fn nothing_is_extrapolated_or_bridged() {
        let trajectory = trajectory();
        assert_eq!(trajectory.at(-1), None);
        assert_eq!(trajectory.at(101), None);
        assert_eq!(trajectory.at(50), None, "a gap is not bridged");
        assert!(trajectory.at(100).is_some(), "its ends are known");
    }
}

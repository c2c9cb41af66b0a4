//! Chooses the times of the keyframes.

use serde::Serialize;

/// The source of the times from which keyframes are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClockSource {
    /// The names of the front camera's images.
    Images,
    /// The rows of `odometry_mu.csv`, which NCLT wrote at the images.
    RelativeOdometry,
    /// A fixed period.
    Period,
}

impl ClockSource {
    /// The name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Images => "the images",
            Self::RelativeOdometry => "odometry_mu.csv",
            Self::Period => "a fixed period",
        }
    }
}

/// Chooses every `keep`-th of the clock's times within the odometry, starting with the first.
///
/// `clock` has the ascending times of images. If it is empty, the times are `period` microseconds apart, from the first
/// time of the odometry.
pub fn keyframe_times(clock: &[i64], period: i64, keep: usize, first: i64, last: i64) -> Vec<i64> {
    let keep = keep.max(1);
    if clock.is_empty() {
        let step = period.max(1).saturating_mul(i64::try_from(keep).unwrap_or(i64::MAX));
        return std::iter::successors(Some(first), |time| time.checked_add(step))
            .take_while(|&time| time <= last)
            .collect();
    }
    clock.iter().copied().filter(|time| (first..=last).contains(time)).step_by(keep).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tenth_covered_image_is_kept() {
        let clock: Vec<i64> = (0..100).collect();
        assert_eq!(keyframe_times(&clock, 0, 10, 5, 47), [5, 15, 25, 35, 45]);
    }

    #[test]
    fn a_period_fills_the_covered_time() {
        assert_eq!(keyframe_times(&[], 200, 10, 1_000, 5_999), [1_000, 3_000, 5_000]);
        assert_eq!(keyframe_times(&[], 200, 10, 7, 7), [7]);
        assert_eq!(keyframe_times(&[], 200, 10, 8, 7), [0; 0]);
    }
}

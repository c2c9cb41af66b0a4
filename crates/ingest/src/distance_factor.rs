//! How far the odometry's distances are off, by ground truth: wheels of another size than assumed.

use posecut_geometry::{LieGroup as _, SE3};

use crate::Trajectory;

/// Length of the stretches that are compared, metres: long beside the noise of positions, short beside the drift of the heading.
const STRETCH: f64 = 20.0;

/// Fewest stretches for an estimate.
const FEWEST: usize = 10;

/// A factor is reported if it differs from 1 by more than this.
const NOTABLE: f64 = 0.02;

/// The factor between the true distances and those of the odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistanceFactor {
    /// The median over the stretches: below 1 if the odometry over-reads.
    pub median: f64,
    /// A robust standard deviation of that median: 1.2533 times 1.4826 times the median absolute deviation of the stretches, over the
    /// root of their number.
    pub deviation: f64,
    /// Number of stretches.
    pub stretches: usize,
}

impl DistanceFactor {
    /// Compares straight distances between the ends of stretches. `None` without enough ground truth.
    pub(crate) fn of(times: &[i64], odometry: &Trajectory, truth: Option<&Trajectory>) -> Option<Self> {
        let truth = truth?;
        let mut ratios = Vec::new();
        let mut start: Option<(SE3, SE3)> = None;
        for &time in times {
            // Nothing is compared across a gap of the truth.
            let Some(now) = odometry.at(time).zip(truth.at(time)) else {
                start = None;
                continue;
            };
            let Some(from) = &start else {
                start = Some(now);
                continue;
            };
            let measured = length(&from.0, &now.0);
            if measured >= STRETCH {
                ratios.push(length(&from.1, &now.1) / measured);
                start = Some(now);
            }
        }
        (ratios.len() >= FEWEST).then(|| Self::over(ratios))
    }

    fn over(mut ratios: Vec<f64>) -> Self {
        let median = median(&mut ratios);
        let mut deviations: Vec<f64> = ratios.iter().map(|ratio| (ratio - median).abs()).collect();
        let spread = 1.2533 * 1.4826 * self::median(&mut deviations);
        Self { median, deviation: spread / (ratios.len() as f64).sqrt(), stretches: ratios.len() }
    }

    /// Whether the odometry is off by more than a bend of the path or noise explain.
    pub fn is_notable(&self) -> bool {
        let off = (self.median - 1.0).abs();
        off > NOTABLE && off > 3.0 * self.deviation
    }
}

fn length(from: &SE3, to: &SE3) -> f64 {
    from.between(to).components()[..3].iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A path with a slow bend, one step a second; the positions are scaled by a factor.
    fn path(scale: f64) -> Trajectory {
        let pose = |step: i64| {
            let angle = 0.01 * step as f64;
            SE3::from_components(&[
                200.0 * scale * angle.sin(),
                200.0 * scale * angle.cos(),
                0.0,
                0.0,
                0.0,
                0.0,
                1.0,
            ])
        };
        Trajectory {
            times: (0..400).map(|step| step * 1_000_000).collect(),
            poses: (0..400).map(|step| pose(step).unwrap()).collect(),
            gaps: Vec::new(),
        }
    }

    #[test]
    fn the_factor_of_wheels_that_over_read_is_found() {
        let truth = path(1.0);
        let found = DistanceFactor::of(&truth.times, &path(1.07), Some(&truth)).unwrap();
        assert!((found.median - 1.0 / 1.07).abs() < 1e-9 && found.is_notable(), "{found:?}");
        let exact = DistanceFactor::of(&truth.times, &truth, Some(&truth)).unwrap();
        assert!(!exact.is_notable(), "{exact:?}");
        assert_eq!(DistanceFactor::of(&truth.times[..30], &truth, Some(&truth)), None, "too short");
        assert_eq!(DistanceFactor::of(&truth.times, &truth, None), None);
    }
}

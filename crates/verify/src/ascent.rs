//! The ascent to the factors that explain loops best.

use rayon::prelude::*;

use crate::mixture::{Contrast, Loops};

/// The smallest factor of landmark edges. Neighbouring keyframes share scans, so their measurements agree with each other better than with
/// the world: loops through two of them ask for a factor near 0.01 on the log intel. Six edges, all off by the same 5 m, then bent the map.
pub(crate) const LANDMARK_LEAST: f64 = 0.1;
/// Variance of a local error over that of landmark noise, if local errors are exceptions: thirty standard deviations, squared.
pub(crate) const EXCEPTION: f64 = 900.0;
/// The smallest factor on the claimed covariance for a local error that is common: a narrower one is noise.
const NARROWEST: f64 = 100.0;
/// The largest one: a hundred standard deviations, squared. A wider one is an edge between the wrong places.
pub(crate) const WIDEST: f64 = 1e4;
/// The largest coherent variance allowed.
const COHERENT_MOST: f64 = 1e-2;

/// Logarithms of the factors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point {
    pub(crate) odometry: f64,
    pub(crate) landmark: f64,
    pub(crate) coherent: f64,
    pub(crate) short: f64,
    pub(crate) local: f64,
    /// That of the rest of a local error relative to that of its translation.
    pub(crate) turning: f64,
}

/// A factor that the ascent moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Axis {
    Odometry,
    Landmark,
    Coherent,
    Short,
    Local,
    Turning,
}

/// Coordinate ascent with steps that halve. Coarse steps over a sample of the loops run from every start; fine steps over all
/// loops then continue from the best result.
pub(crate) fn highest(
    starts: &[Point],
    axes: &[Axis],
    objective: impl Fn(Point, Loops) -> Contrast + Sync,
) -> Option<(Point, Contrast)> {
    let (some, all) = (|point| objective(point, Loops::Some), |point| objective(point, Loops::All));
    let ascended = starts.par_iter().map(|&start| {
        let (point, _) = ascend((start, some(start)), axes, &[2.0, 1.0], some);
        (point, all(point))
    });
    // The first of the highest, independent of the order in which threads finish.
    let best = ascended
        .collect::<Vec<_>>()
        .into_iter()
        .reduce(|best, found| if found.1.objective > best.1.objective { found } else { best });
    best.map(|best| ascend(best, axes, &[1.0, 0.5, 0.25, 0.125], all))
}

fn ascend(
    start: (Point, Contrast),
    axes: &[Axis],
    steps: &[f64],
    objective: impl Fn(Point) -> Contrast,
) -> (Point, Contrast) {
    let (mut point, mut value) = start;
    // Points already evaluated were not higher.
    let mut seen = vec![point];
    for step in steps {
        let mut improved = true;
        while improved {
            improved = false;
            for (&axis, direction) in axes.iter().flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
                let trial = point.moved(axis, direction * step);
                if seen.iter().any(|seen| seen.is(&trial)) {
                    continue;
                }
                seen.push(trial);
                let found = objective(trial);
                if found.objective > value.objective + 1e-9 {
                    (point, value, improved) = (trial, found, true);
                }
            }
        }
    }
    (point, value)
}

impl Point {
    /// Whether two points are equal up to rounding.
    fn is(&self, other: &Self) -> bool {
        let apart = [
            self.odometry - other.odometry,
            self.landmark - other.landmark,
            self.coherent - other.coherent,
            self.short - other.short,
            self.local - other.local,
            self.turning - other.turning,
        ];
        apart.iter().all(|apart| apart.abs() < 1e-9)
    }

    fn moved(mut self, axis: Axis, by: f64) -> Self {
        match axis {
            Axis::Odometry => self.odometry += by,
            Axis::Landmark => self.landmark = (self.landmark + by).max(LANDMARK_LEAST.ln()),
            Axis::Short => self.short += by,
            Axis::Local => self.local = (self.local + by).clamp(NARROWEST.ln(), WIDEST.ln()),
            Axis::Turning => self.turning = (self.turning + 2.0 * by).clamp(-WIDEST.ln(), 0.0),
            Axis::Coherent => self.coherent = (self.coherent + 2.0 * by).min(COHERENT_MOST.ln()),
        }
        self
    }
}

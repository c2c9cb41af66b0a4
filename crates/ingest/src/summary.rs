//! A session's graph in numbers.

use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::PoseGraph;
use posecut_matching::laser_odometry::spread;

use crate::covariance::step_error;
use crate::distance_factor::DistanceFactor;
use crate::nees::nees;
use crate::odometry::Odometry;
use crate::{ClockSource, HeadingSource, Nees, OdometrySource, Trajectory};

/// A session's graph in numbers: its size, its sources, what was left out, and how wrong its odometry is.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The session's name.
    pub session: String,
    /// Number of keyframes.
    pub keyframes: usize,
    /// Number of keyframes with ground truth.
    pub keyframes_with_truth: usize,
    /// Length of the path by odometry, metres.
    pub path_length: f64,
    /// Length of the path by ground truth, metres.
    pub true_path_length: Option<f64>,
    /// Time from the first keyframe to the last, seconds.
    pub duration: f64,
    /// The source of the odometry.
    pub odometry: OdometrySource,
    /// The source of the heading, with wheels.
    pub heading: Option<HeadingSource>,
    /// The source of the keyframes' times.
    pub clock: ClockSource,
    /// Where the covariances are from.
    pub covariance: CovarianceSource,
    /// The factor between the true distances and those of the odometry; `None` without enough ground truth.
    pub distance_factor: Option<DistanceFactor>,
    /// Rows of all files that were left out.
    pub dropped_rows: usize,
    /// Those of the odometry's files.
    pub odometry_dropped_rows: usize,
    /// Rows of ground truth that repeat one pose while the odometry moves.
    pub frozen_truth_rows: usize,
    /// Gaps of the odometry.
    pub gaps: usize,
    /// Gaps of the ground truth.
    pub truth_gaps: Option<usize>,
    /// Errors of the odometry over one keyframe step, if there is ground truth.
    pub step_errors: StepErrors,
    /// The same in units of the covariances.
    pub nees: Vec<Nees>,
}

/// Where the covariances of the odometry are from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CovarianceSource {
    /// The session's files.
    File,
    /// Options give both standard deviations.
    Options,
    /// At least one standard deviation is a default, because neither the session nor an option gives it.
    Default,
}

impl CovarianceSource {
    /// The name in `--stats`.
    pub fn name(self) -> &'static str {
        match self {
            Self::File => "file",
            Self::Options => "options",
            Self::Default => "default",
        }
    }
}

/// Errors of steps between keyframes: for each axis the root mean square, and a robust standard deviation (1.4826 times
/// the median of the absolute values). `None` without ground truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepErrors {
    /// Metres.
    pub forward: Option<[f64; 2]>,
    /// Metres.
    pub sideways: Option<[f64; 2]>,
    /// Radians.
    pub heading: Option<[f64; 2]>,
}

/// Where a graph comes from.
pub(crate) struct Origin<'a> {
    pub(crate) session: &'a str,
    pub(crate) odometry: &'a Odometry,
    pub(crate) truth: Option<&'a Trajectory>,
    pub(crate) clock: ClockSource,
    pub(crate) covariance: CovarianceSource,
    pub(crate) dropped_rows: usize,
    pub(crate) frozen_truth_rows: usize,
}

impl Summary {
    pub(crate) fn of(graph: &PoseGraph, origin: &Origin<'_>) -> Self {
        let Origin { odometry, truth, .. } = *origin;
        let times: Vec<i64> = graph.nodes.iter().filter_map(|node| node.utime).collect();
        Self {
            session: origin.session.to_owned(),
            keyframes: graph.nodes.len(),
            keyframes_with_truth: graph.nodes.iter().filter(|node| node.truth.is_some()).count(),
            path_length: odometry.trajectory.path_length(),
            true_path_length: truth.map(Trajectory::path_length),
            duration: seconds_between(&times),
            odometry: odometry.source,
            heading: odometry.heading,
            clock: origin.clock,
            covariance: origin.covariance,
            distance_factor: DistanceFactor::of(&times, &odometry.trajectory, truth),
            dropped_rows: origin.dropped_rows,
            odometry_dropped_rows: odometry.dropped_rows,
            frozen_truth_rows: origin.frozen_truth_rows,
            gaps: odometry.trajectory.gaps.len(),
            truth_gaps: truth.map(|truth| truth.gaps.len()),
            step_errors: StepErrors::of(&times, &odometry.trajectory, truth),
            nees: nees(graph),
        }
    }
}

impl StepErrors {
    fn of(times: &[i64], odometry: &Trajectory, truth: Option<&Trajectory>) -> Self {
        let poses: Vec<Option<(SE3, SE3)>> =
            times.iter().map(|&time| Some((odometry.at(time)?, truth?.at(time)?))).collect();
        let errors: Vec<[f64; 6]> = poses
            .windows(2)
            .filter_map(|pair| {
                let ((measured_from, true_from), (measured_to, true_to)) = (pair[0]?, pair[1]?);
                Some(step_error(&measured_from.between(&measured_to), &true_from.between(&true_to)))
            })
            .collect();
        let axis = |axis: usize| {
            let values: Vec<f64> = errors.iter().map(|error| error[axis]).collect();
            (!values.is_empty()).then(|| spread(&values))
        };
        Self { forward: axis(0), sideways: axis(1), heading: axis(5) }
    }
}

fn seconds_between(times: &[i64]) -> f64 {
    match (times.first(), times.last()) {
        (Some(first), Some(last)) => (last - first) as f64 * 1e-6,
        _ => 0.0,
    }
}

//! Builds the graph of a session from its files.

use posecut_geometry::covariance::isotropic_information;
use posecut_geometry::{LieGroup, SE3};
use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, NodeTruth, NoiseModel, PoseGraph};
use posecut_stage::{ProgressBar, Statistics, info, warn};

use crate::clock::{ClockSource, keyframe_times};
use crate::covariance::step_error;
use crate::frozen::remove_frozen_ends;
use crate::nees::nees;
use crate::odometry::{self, Odometry, Reader, from_row};
use crate::{FileKind, IngestError, Options, SessionFiles, Table, Trajectory};

/// The name of the noise model of all odometry edges, used if the options give the standard deviations.
const NOISE_MODEL: &str = "odometry";

/// No drive has more periods than this: at five a second it is 23 days.
const MOST_PERIODS: u64 = 10_000_000;

/// A session's graph, with statistics.
pub struct Ingested {
    /// One session: keyframes, odometry edges, truth.
    pub graph: PoseGraph,
    /// Figures for `--stats`.
    pub statistics: Statistics,
    /// The default standard deviations of odometry, metres and radians, if neither the session nor the options give
    /// any.
    pub invented: Option<(f64, f64)>,
}

/// Reads a session. It is in memory as a whole. O(rows).
pub fn ingest(
    files: &mut SessionFiles,
    options: &Options,
    progress: &ProgressBar,
) -> Result<Ingested, IngestError> {
    let name = options.name.clone().unwrap_or_else(|| files.name.clone());
    let mut reader = Reader { files, progress, dropped_rows: 0 };
    let odometry = odometry::read(&mut reader, options)?;
    let mut truth = read_truth(&mut reader, options)?;
    let dropped_rows = reader.dropped_rows;
    let frozen = truth.as_mut().map_or(0, |truth| remove_frozen_ends(truth, &odometry.trajectory));
    if frozen > 0 {
        warn!(
            "{}: {frozen} rows of ground truth left out at its ends: they repeat one pose while the odometry moves",
            files.place()
        );
    }
    let (clock_source, times) = keyframes(files, &odometry, options)?;
    let builder = Builder { name, odometry: &odometry, truth: truth.as_ref(), options };
    let graph = builder.graph(&times)?;
    let mut statistics = builder.statistics(&graph);
    statistics.note("dropped_rows", dropped_rows);
    statistics.note("frozen_truth_rows", frozen);
    statistics.note("clock", clock_source);
    progress.finish_and_clear();
    Ok(Ingested { invented: builder.invented(), graph, statistics })
}

fn read_truth(reader: &mut Reader<'_>, options: &Options) -> Result<Option<Trajectory>, IngestError> {
    if !reader.files.has(FileKind::GroundTruth) {
        warn!(
            "{}: there is no ground truth (groundtruth_DATE.csv); nothing can be evaluated",
            reader.files.place()
        );
        return Ok(None);
    }
    let table: Table = reader.table(FileKind::GroundTruth, 6)?;
    let longest = (options.longest_silence * 1e6) as i64;
    let gaps = table.gaps(longest).collect();
    let poses = table.rows.iter().map(|row| from_row(row)).collect();
    Ok(Some(Trajectory { times: table.times, poses, gaps }))
}

/// The keyframe times that the odometry covers.
fn keyframes(
    files: &SessionFiles,
    odometry: &Odometry,
    options: &Options,
) -> Result<(ClockSource, Vec<i64>), IngestError> {
    let trajectory = &odometry.trajectory;
    let (Some(&first), Some(&last)) = (trajectory.times.first(), trajectory.times.last()) else {
        return Err(IngestError::session(
            files.place(),
            "the odometry is empty",
            "download the session again",
        ));
    };
    let (source, clock): (ClockSource, &[i64]) = if !files.image_times.is_empty() {
        (ClockSource::Images, &files.image_times)
    } else if odometry.source == odometry::OdometrySource::Relative {
        (ClockSource::RelativeOdometry, &trajectory.times)
    } else {
        (ClockSource::Period, &[])
    };
    let period = (options.period * 1e6) as i64;
    let periods = last.abs_diff(first) / period.max(1).unsigned_abs();
    if clock.is_empty() && periods > MOST_PERIODS {
        return Err(IngestError::session(
            files.place(),
            format!(
                "its odometry covers {first} to {last} us, {periods} periods, which is no drive but a clock that jumps"
            ),
            "correct the stamps in the first column, or lengthen --period",
        ));
    }
    let all = keyframe_times(clock, period, options.keep_every as usize, first, last);
    let times: Vec<i64> = all.iter().copied().filter(|&time| trajectory.at(time).is_some()).collect();
    if times.len() < all.len() {
        warn!(
            "{}: {} keyframes fall into gaps of the odometry and are left out",
            files.place(),
            all.len() - times.len()
        );
    }
    if times.len() < 2 {
        return Err(IngestError::session(
            files.place(),
            format!(
                "{} keyframes remain of {} images or periods, and a session needs two",
                times.len(),
                all.len()
            ),
            "keep more with --keep-every, or check that images and odometry are of the same session",
        ));
    }
    info!("{} keyframes, one of {} by {}", times.len(), options.keep_every, source.name());
    Ok((source, times))
}

struct Builder<'a> {
    name: String,
    odometry: &'a Odometry,
    truth: Option<&'a Trajectory>,
    options: &'a Options,
}

impl Builder<'_> {
    fn planar(&self) -> bool {
        self.options.dimension == 2
    }

    fn graph(&self, times: &[i64]) -> Result<PoseGraph, IngestError> {
        let dimension = if self.planar() { Dimension::Two } else { Dimension::Three };
        let mut graph = PoseGraph::new(Header::new(dimension));
        let from_file = self.covariances();
        if from_file.is_none() {
            graph.header.noise_models.push((NOISE_MODEL.to_owned(), self.noise_model()));
        }
        let start = self.odometry.trajectory.at(times[0]).unwrap_or_else(SE3::identity);
        let mut previous: Option<(i64, Vec<f64>)> = None;
        for (index, &time) in times.iter().enumerate() {
            let Some(pose) = self.odometry.trajectory.at(time) else { continue };
            let pose = self.components(&start, &pose);
            let truth = self.truth.and_then(|truth| truth.at(time));
            graph.nodes.push(Node {
                id: index as u64,
                session: Some(self.name.clone()),
                frame: Some(index as i64),
                utime: Some(time),
                truth: truth.map(|truth| NodeTruth {
                    pose: Some(self.components(&SE3::identity(), &truth)),
                    ..NodeTruth::default()
                }),
                pose: Some(pose.clone()),
                ..Node::default()
            });
            if let Some((before, from)) = previous {
                let mut edge =
                    Edge::new(EdgeKind::Odometry, index as u64 - 1, index as u64 - 1, index as u64);
                edge.measurement = Some(self.relative(&from, &pose));
                match from_file {
                    None => edge.noise = Some(NOISE_MODEL.to_owned()),
                    Some(covariances) => {
                        edge.information = Some(covariances.information_between(
                            &self.odometry.trajectory,
                            before,
                            time,
                            self.planar(),
                        )?);
                    }
                }
                graph.edges.push(edge);
            }
            previous = Some((time, pose));
        }
        Ok(graph)
    }

    /// The covariances of the session's files, unless the options give standard deviations.
    fn covariances(&self) -> Option<&crate::covariance::StepCovariances> {
        let given = self.options.sigma_translation.is_some() || self.options.sigma_rotation.is_some();
        self.odometry.covariances.as_ref().filter(|_| !given)
    }

    /// Standard deviations to use without a covariance file: metres and radians.
    fn sigmas(&self) -> (f64, f64) {
        let (translation, rotation) = Options::DEFAULT_SIGMA;
        (
            self.options.sigma_translation.unwrap_or(translation),
            self.options.sigma_rotation.unwrap_or(rotation),
        )
    }

    /// The same standard deviations if at least one of them is a default that is used.
    fn invented(&self) -> Option<(f64, f64)> {
        let given = self.options.sigma_translation.is_some() && self.options.sigma_rotation.is_some();
        (self.covariances().is_none() && !given).then(|| self.sigmas())
    }

    fn noise_model(&self) -> NoiseModel {
        let (translation, rotation) = self.sigmas();
        NoiseModel {
            information: isotropic_information(if self.planar() { 3 } else { 6 }, translation, rotation),
            extra: posecut_graph::Extra::new(),
        }
    }

    /// A pose relative to a start, in the graph's dimension. In the plane both are projected first, so that slopes
    /// shorten distances as on a map.
    fn components(&self, start: &SE3, pose: &SE3) -> Vec<f64> {
        if self.planar() {
            start.to_planar().between(&pose.to_planar()).components()
        } else {
            start.between(pose).components()
        }
    }

    fn relative(&self, from: &[f64], to: &[f64]) -> Vec<f64> {
        fn between<G: LieGroup<DOF>, const DOF: usize>(from: &[f64], to: &[f64]) -> Option<Vec<f64>> {
            Some(G::from_components(from)?.between(&G::from_components(to)?).components())
        }
        let measurement = if self.planar() {
            between::<posecut_geometry::SE2, 3>(from, to)
        } else {
            between::<SE3, 6>(from, to)
        };
        measurement.unwrap_or_default()
    }

    fn statistics(&self, graph: &PoseGraph) -> Statistics {
        let mut statistics = Statistics::default();
        let gaps = self.odometry.trajectory.gaps.len();
        if gaps > 0 {
            warn!(
                "{}: the odometry has {gaps} gaps longer than {} s",
                self.name, self.options.longest_silence
            );
        }
        let times: Vec<i64> = graph.nodes.iter().filter_map(|node| node.utime).collect();
        let poses: Vec<Option<(SE3, SE3)>> = times
            .iter()
            .map(|&time| Some((self.odometry.trajectory.at(time)?, self.truth?.at(time)?)))
            .collect();
        let errors: Vec<[f64; 6]> = poses
            .windows(2)
            .filter_map(|pair| {
                let ((measured_from, true_from), (measured_to, true_to)) = (pair[0]?, pair[1]?);
                Some(step_error(&measured_from.between(&measured_to), &true_from.between(&true_to)))
            })
            .collect();
        statistics.note("session", &self.name);
        statistics.note("keyframes", graph.nodes.len());
        statistics
            .note("keyframes_with_truth", graph.nodes.iter().filter(|node| node.truth.is_some()).count());
        statistics.note("path_length_m", self.odometry.trajectory.path_length());
        statistics.note("true_path_length_m", self.truth.map(Trajectory::path_length));
        statistics.note("duration_s", seconds_between(&times));
        statistics.note("odometry", self.odometry.source);
        statistics.note("heading", self.odometry.heading);
        statistics.note("odometry_dropped_rows", self.odometry.dropped_rows);
        statistics.note("gaps", gaps);
        statistics.note("truth_gaps", self.truth.map(|truth| truth.gaps.len()));
        statistics.note("covariance", if self.covariances().is_some() { "file" } else { "options" });
        let axis =
            |pick: fn(&[f64; 6]) -> f64| -> Option<[f64; 2]> { spread(errors.iter().map(pick).collect()) };
        statistics.note("step_error_forward_m", axis(|error| error[0]));
        statistics.note("step_error_sideways_m", axis(|error| error[1]));
        statistics.note("step_error_heading_rad", axis(|error| error[5]));
        statistics.note("nees", nees(graph));
        statistics
    }
}

fn seconds_between(times: &[i64]) -> f64 {
    match (times.first(), times.last()) {
        (Some(first), Some(last)) => (last - first) as f64 * 1e-6,
        _ => 0.0,
    }
}

/// Root mean square, and a robust standard deviation (1.4826 times the median of the absolute values).
fn spread(mut values: Vec<f64>) -> Option<[f64; 2]> {
    if values.is_empty() {
        return None;
    }
    let root_mean_square =
        (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt();
    for value in &mut values {
        *value = value.abs();
    }
    values.sort_by(f64::total_cmp);
    Some([root_mean_square, 1.4826 * values[values.len() / 2]])
}

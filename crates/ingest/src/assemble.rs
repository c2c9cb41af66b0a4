//! Builds the graph of a session from its files.

use posecut_geometry::covariance::isotropic_information;
use posecut_geometry::{LieGroup, SE3};
use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, NodeTruth, NoiseModel, PoseGraph};
use posecut_matching::laser_odometry::Comparison;

use crate::clock::{ClockSource, keyframe_times};
use crate::distance_factor::DistanceFactor;
use crate::frozen::remove_frozen_ends;
use crate::gps;
use crate::laser;
use crate::odometry::{self, Odometry, Reader, from_row};
use crate::scan_matching;
use crate::summary::{CovarianceSource, Origin, Summary};
use crate::{Choice, Event, FileKind, IngestError, Laser, Options, SessionFiles, Table, Trajectory, Warning};

/// The name of the noise model of all odometry edges, used if the options give the standard deviations.
const NOISE_MODEL: &str = "odometry";

/// No drive has more periods than this: at five a second it is 23 days.
const MOST_PERIODS: u64 = 10_000_000;

/// A session's graph, also in numbers.
pub struct Ingested {
    /// One session: keyframes, odometry edges, truth.
    pub graph: PoseGraph,
    /// The graph in numbers.
    pub summary: Summary,
    /// The default standard deviations of odometry, metres and radians, if neither the session nor the options give
    /// any.
    pub invented: Option<(f64, f64)>,
    /// Laser scans at the keyframes, if the session has them. They are not in the graph.
    pub laser: Option<Laser>,
    /// How well the odometry agrees with the scans, if these were matched.
    pub comparison: Option<Comparison>,
}

/// Reads a session. It is in memory as a whole. O(rows).
pub fn ingest(
    files: &mut SessionFiles,
    options: &Options,
    report: &mut dyn FnMut(Event<'_>),
) -> Result<Ingested, IngestError> {
    let session = options.name.clone().unwrap_or_else(|| files.name.clone());
    scan_matching::check(files, options)?;
    let mut reader = Reader { files, report, dropped_rows: 0 };
    let odometry = odometry::read(&mut reader, options)?;
    let mut truth = read_truth(&mut reader, options)?;
    let frozen = truth.as_mut().map_or(0, |truth| remove_frozen_ends(truth, &odometry.trajectory));
    if frozen > 0 {
        reader.warn(Warning::FrozenTruth { place: reader.files.place().to_owned(), rows: frozen });
    }
    let (clock, times) = keyframes(&mut reader, &odometry, options)?;
    let builder = Builder { session: &session, odometry: &odometry, truth: truth.as_ref(), options };
    let mut graph = builder.graph(&times)?;
    gps::add(&mut reader, &mut graph, options)?;
    let laser = laser::read(&mut reader, &graph, &odometry.trajectory)?;
    let comparison = match &laser {
        Some(laser) if options.scan_matching => Some(scan_matching::refine(&mut graph, laser)?),
        _ => None,
    };
    let gaps = odometry.trajectory.gaps.len();
    if gaps > 0 {
        let longest_silence = options.longest_silence;
        reader.warn(Warning::Gaps { session: session.clone(), gaps, longest_silence });
    }
    let origin = Origin {
        session: &session,
        odometry: &odometry,
        truth: truth.as_ref(),
        clock,
        covariance: builder.source(),
        dropped_rows: reader.dropped_rows,
        frozen_truth_rows: frozen,
    };
    let summary = Summary::of(&graph, &origin);
    if let Some(found) = summary.distance_factor.filter(DistanceFactor::is_notable) {
        reader.warn(Warning::WrongDistances {
            session: session.clone(),
            found,
            wheel_scale: options.wheel_scale,
        });
    }
    Ok(Ingested { invented: builder.invented(), graph, summary, laser, comparison })
}

fn read_truth(reader: &mut Reader<'_>, options: &Options) -> Result<Option<Trajectory>, IngestError> {
    if !reader.files.has(FileKind::GroundTruth) {
        reader.warn(Warning::NoTruth { place: reader.files.place().to_owned() });
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
    reader: &mut Reader<'_>,
    odometry: &Odometry,
    options: &Options,
) -> Result<(ClockSource, Vec<i64>), IngestError> {
    let (files, trajectory) = (&*reader.files, &odometry.trajectory);
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
                "its odometry covers {first} to {last} us, {periods} periods: too long for a drive, so its clock jumps"
            ),
            "correct the times in the first column, or increase --period",
        ));
    }
    let all = keyframe_times(clock, period, options.keep_every as usize, first, last);
    let times: Vec<i64> = all.iter().copied().filter(|&time| trajectory.at(time).is_some()).collect();
    if times.len() < all.len() {
        (reader.report)(Event::Warning(Warning::KeyframesInGaps {
            place: files.place().to_owned(),
            left_out: all.len() - times.len(),
            keyframes: all.len(),
        }));
    }
    if times.len() < 2 {
        return Err(IngestError::session(
            files.place(),
            format!(
                "too few keyframes: {} of {} images or periods, but a session needs 2",
                times.len(),
                all.len()
            ),
            "decrease --keep-every, and make sure that images and odometry belong to the same session",
        ));
    }
    (reader.report)(Event::Chosen(Choice::Keyframes {
        number: times.len(),
        keep_every: options.keep_every,
        clock: source,
    }));
    Ok((source, times))
}

struct Builder<'a> {
    session: &'a str,
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
                session: Some(self.session.to_owned()),
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

    fn source(&self) -> CovarianceSource {
        match (self.covariances(), self.invented()) {
            (Some(_), _) => CovarianceSource::File,
            (None, None) => CovarianceSource::Options,
            (None, Some(_)) => CovarianceSource::Default,
        }
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
}

//! The pose graph of a log.

use posecut_geometry::covariance::pack_upper_triangle;
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::{Dimension, Edge, EdgeKind, Header, Node, NodeTruth, PoseGraph};
use posecut_matching::laser_odometry::{Comparison, Measured, by_matching};
use posecut_scan::{LaserScan, put_into_graph};
use serde::Serialize;

use crate::keyframes::keyframes;
use crate::log::{Log, Repairs};
use crate::noise;
use crate::{LogError, LogOptions};

/// A log as a session.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Keyframes with poses by odometry, and odometry edges. The scans are not in it.
    pub graph: PoseGraph,
    /// The scan of each node.
    pub scans: Vec<LaserScan>,
    /// For each node the index of its scan in the log.
    pub chosen: Vec<usize>,
    /// The session in numbers.
    pub summary: Summary,
}

/// A session in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The name of the session.
    pub session: String,
    /// Scans in the log that were usable.
    pub scans: usize,
    /// Number of keyframes.
    pub keyframes: usize,
    /// Number of keyframes with a true pose.
    pub keyframes_with_truth: usize,
    /// Length of the path, metres.
    pub path_length_m: f64,
    /// Sum of the turns, radians.
    pub turning_rad: f64,
    /// From the earliest to the latest scan, seconds.
    pub duration_s: f64,
    /// Beams of a scan.
    pub beams: usize,
    /// Share of the beams of keyframes that have a return.
    pub returns: f64,
    /// What was repaired or left out.
    pub repairs: Repairs,
    /// With scan matching: how well the odometry agrees with it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scan_matching: Option<Comparison>,
}

impl Session {
    /// Makes a session of a log. `place` is the log's name for messages. O(scans), with scan matching O(keyframes * beams) more.
    pub fn of_log(place: &str, name: &str, log: &Log, options: &LogOptions) -> Result<Self, LogError> {
        let (chosen, steps) = keyframes(&log.scans, options);
        if chosen.len() < 2 {
            return Err(LogError::Log {
                place: place.to_owned(),
                problem: format!(
                    "the odometry never moves by {} m or {} rad in {} scans, so there is one keyframe, but a session needs 2",
                    options.keyframe_distance,
                    options.keyframe_angle,
                    log.scans.len()
                ),
                remedy: "decrease --keyframe-distance, or use a log with odometry".to_owned(),
            });
        }
        let scans: Vec<&LaserScan> = chosen.iter().map(|&index| &log.scans[index].scan).collect();
        let odometry: Vec<Measured> = steps.iter().map(noise::measured).collect();
        let (measured, comparison) = if options.scan_matching {
            let scans: Vec<Option<&LaserScan>> = scans.iter().copied().map(Some).collect();
            let (measured, comparison) = by_matching(&odometry, &scans);
            (measured, Some(comparison))
        } else {
            (odometry, None)
        };
        let graph = graph(name, log, &chosen, &measured);
        let beams = scans.first().map_or(0, |scan| scan.ranges.len());
        let returns: usize = scans.iter().map(|scan| scan.returns()).sum();
        let times = || log.scans.iter().map(|scan| scan.time);
        let duration = times().max().unwrap_or(0) - times().min().unwrap_or(0);
        let summary = Summary {
            session: name.to_owned(),
            scans: log.scans.len(),
            keyframes: chosen.len(),
            keyframes_with_truth: graph.nodes.iter().filter(|node| node.truth.is_some()).count(),
            path_length_m: steps.iter().map(|step| step.distance).sum(),
            turning_rad: steps.iter().map(|step| step.turning).sum(),
            duration_s: duration as f64 * 1e-6,
            beams,
            returns: returns as f64 / (beams * scans.len()).max(1) as f64,
            repairs: log.repairs,
            scan_matching: comparison,
        };
        let scans = scans.into_iter().cloned().collect();
        Ok(Self { graph, scans, chosen, summary })
    }

    /// Puts the scans into the graph, as records after its edges.
    ///
    /// # Errors
    ///
    /// A scan cannot be written as JSON.
    pub fn put_scans_into_graph(&mut self) -> serde_json::Result<()> {
        let nodes: Vec<u64> = self.graph.nodes.iter().map(|node| node.id).collect();
        put_into_graph(nodes.into_iter().zip(&self.scans), &mut self.graph)
    }
}

fn graph(name: &str, log: &Log, chosen: &[usize], measured: &[Measured]) -> PoseGraph {
    let mut graph = PoseGraph::new(Header::new(Dimension::Two));
    let mut pose = SE2::identity();
    for (node, &index) in chosen.iter().enumerate() {
        if node > 0 {
            let step = &measured[node - 1];
            pose = pose.compose(&step.motion);
            let id = node as u64;
            let mut edge = Edge::new(EdgeKind::Odometry, id - 1, id - 1, id);
            edge.measurement = Some(step.motion.components());
            edge.information = Some(pack_upper_triangle(&step.information));
            graph.edges.push(edge);
        }
        let time = log.scans[index].time;
        graph.nodes.push(Node {
            id: node as u64,
            session: Some(name.to_owned()),
            frame: Some(node as i64),
            utime: Some(time),
            truth: truth_at(&log.truth, time)
                .map(|pose| NodeTruth { pose: Some(pose.components()), ..NodeTruth::default() }),
            pose: Some(pose.components()),
            ..Node::default()
        });
    }
    graph
}

/// The true pose at the time of a scan: of simulated logs, which write it with each scan.
fn truth_at(truth: &[(i64, SE2)], time: i64) -> Option<SE2> {
    let at = truth.binary_search_by_key(&time, |(time, _)| *time).ok()?;
    Some(truth[at].1)
}

/// The name of a session: that of its file up to the first dot.
pub fn session_name(file: &str) -> String {
    file.split('.').next().filter(|name| !name.is_empty()).unwrap_or("log").to_owned()
}

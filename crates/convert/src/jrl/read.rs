//! Reads JRL datasets.

mod factors;
mod values;

use std::collections::{BTreeMap, BTreeSet};

use posecut_graph::{Dimension, Edge, EdgeKind, EdgeTruth, FIXED, Header, Node, NodeTruth, PoseGraph, Prior};
use serde_json::Value;

use super::covariance::information;
use super::document::{Document, Values};
use crate::odometry::{frame, robot, set_kinds};
use crate::{ConvertError, NextIds, Odometry};
use factors::Measured;
use values::pose;

/// How datasets are read.
#[derive(Clone, Debug)]
pub struct ReadOptions {
    /// The session of keys without a robot's letter.
    pub session: String,
    /// Skip factors and values of other types instead of refusing them.
    pub skip_unknown: bool,
    /// Which edges that are no potential outliers are odometry.
    pub odometry: Odometry,
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self { session: "0".to_owned(), skip_unknown: false, odometry: Odometry::Auto }
    }
}

/// What the reader skipped or inferred.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadSummary {
    /// Number of skipped factors and values, by type.
    pub skipped: BTreeMap<String, usize>,
    /// Priors on the first pose of further robots, which are left out.
    pub priors: usize,
    /// Number of nodes without an initial value.
    pub without_value: usize,
    /// Number of landmark edges with a label.
    pub labelled: usize,
    /// Odometry that was found by the next id, of each robot without consecutive keys.
    pub next_ids: Vec<NextIds>,
}

/// What is known so far.
struct Reader<'a> {
    file: &'a str,
    options: &'a ReadOptions,
    dimension: Option<Dimension>,
    summary: ReadSummary,
}

/// Reads a dataset. Errors name the file and the field. O(size log size).
pub fn read(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
) -> Result<(PoseGraph, ReadSummary), ConvertError> {
    let document = parse(file, bytes)?;
    let mut reader = Reader { file, options, dimension: None, summary: ReadSummary::default() };
    let listed = document.potential_outlier_factors.is_some();
    let measured = reader.factors(
        document.measurements,
        document.potential_outlier_factors,
        document.outlier_factors,
    )?;
    let poses = reader.values("initialization", document.initialization)?;
    let truths = reader.values("groundtruth", document.groundtruth)?;
    let Some(dimension) = reader.dimension else {
        return Err(ConvertError::graph(
            format!("{file}: the dataset has no factor and no value of a pose"),
            "name a dataset with BetweenFactorPose2 or BetweenFactorPose3",
        ));
    };
    let mut graph = PoseGraph::new(Header::new(dimension));
    graph.header.extra.extend(document.name.map(|name| (super::NAME.to_owned(), Value::String(name))));
    reader.add_nodes(&mut graph, &measured, poses, truths);
    reader.anchor(&mut graph, &measured)?;
    reader.add_edges(&mut graph, measured, listed);
    Ok((graph, reader.summary))
}

fn parse(file: &str, bytes: &[u8]) -> Result<Document, ConvertError> {
    // The major type of CBOR's maps is 5.
    if bytes.first().is_some_and(|byte| byte >> 5 == 5) {
        return Err(ConvertError::graph(
            format!("{file}: the dataset is CBOR, the compressed form of JRL"),
            "write it without compression; in Python: json.dump(cbor2.load(open(\"in.jrl.cbor\", \"rb\")), open(\"out.jrl\", \"w\"))",
        ));
    }
    let document: Document = serde_json::from_slice(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes))
        .map_err(|error| {
            let message = error.to_string();
            let message = message.split(" at line ").next().unwrap_or_default();
            let remedy = if error.is_eof() {
                "the file is cut short; write or copy it again"
            } else {
                "a dataset is one JSON object, described in format/DATASET_FORMAT.md of github.com/DanMcGann/jrl"
            };
            let line = error.line() as u64;
            ConvertError::line(file, line, format!("column {}: {message}", error.column()), remedy)
        })?;
    if document.measurements.is_none() {
        return Err(ConvertError::graph(
            format!("{file}: the object has no field \"measurements\""),
            "a JRL dataset has name, robots and measurements; results (.jrr) hold only poses",
        ));
    }
    Ok(document)
}

/// A key as gtsam prints it: the robot's letter and the number.
pub(super) fn symbol(key: u64) -> String {
    robot(key).map_or_else(|| key.to_string(), |letter| format!("{letter}{}", frame(key)))
}

impl Reader<'_> {
    fn refuse(&self, place: &str, problem: &str, remedy: impl Into<String>) -> ConvertError {
        ConvertError::graph(format!("{}, {place}: {problem}", self.file), remedy)
    }

    /// Notes the dimension of a pose or factor; all must have one.
    fn agree(&mut self, dimension: Dimension, place: &str) -> Result<(), ConvertError> {
        match self.dimension.replace(dimension) {
            Some(before) if before != dimension => Err(self.refuse(
                place,
                &format!("dimension {dimension} follows dimension {before}"),
                "a pose graph has one dimension; split the dataset",
            )),
            _ => Ok(()),
        }
    }

    /// Refuses what no pose graph can hold, or counts it.
    fn skip(&mut self, kind: &str, place: &str, remedy: &str) -> Result<(), ConvertError> {
        if !self.options.skip_unknown {
            return Err(self.refuse(
                place,
                &format!("a {kind} cannot be used"),
                format!("{remedy}; --skip-unknown skips others"),
            ));
        }
        *self.summary.skipped.entry(kind.to_owned()).or_default() += 1;
        Ok(())
    }

    /// The poses of all robots by key. Several robots may have one key: its own robot's value counts.
    fn values(
        &mut self,
        field: &str,
        robots: Option<super::document::ByRobot<Values>>,
    ) -> Result<BTreeMap<u64, Vec<f64>>, ConvertError> {
        let mut poses: BTreeMap<u64, Vec<f64>> = BTreeMap::new();
        for (name, values) in robots.map_or_else(Vec::new, |robots| robots.0) {
            let mut own = BTreeSet::new();
            for (key, value) in values.0 {
                let place = format!("{field}.{name}, key {}", symbol(key));
                if !own.insert(key) {
                    return Err(self.refuse(&place, "the key occurs twice", "keep one of the two"));
                }
                let dimension = match value.kind.as_deref() {
                    Some("Pose2") => Dimension::Two,
                    Some("Pose3") => Dimension::Three,
                    kind => {
                        let kind = kind.unwrap_or("value without a type").to_owned();
                        self.skip(&kind, &place, "values of pose graphs are Pose2 and Pose3")?;
                        continue;
                    }
                };
                self.agree(dimension, &place)?;
                let pose = pose(&value, dimension)
                    .map_err(|(problem, remedy)| self.refuse(&place, &problem, remedy))?;
                let is_own = robot(key).is_some_and(|letter| name == letter.to_string());
                if is_own || !poses.contains_key(&key) {
                    poses.insert(key, pose);
                }
            }
        }
        Ok(poses)
    }

    fn add_nodes(
        &mut self,
        graph: &mut PoseGraph,
        measured: &Measured,
        mut poses: BTreeMap<u64, Vec<f64>>,
        mut truths: BTreeMap<u64, Vec<f64>>,
    ) {
        let ends = measured.edges.iter().flat_map(|edge| [edge.from, edge.to]);
        let priors = measured.priors.iter().map(|prior| prior.key);
        let keys: BTreeSet<u64> =
            ends.chain(priors).chain(poses.keys().copied()).chain(truths.keys().copied()).collect();
        for key in keys {
            let (session, frame) = crate::odometry::session_and_frame(key, &self.options.session);
            let node = Node {
                id: key,
                session: Some(session),
                frame: Some(frame),
                pose: poses.remove(&key),
                truth: truths.remove(&key).map(|pose| NodeTruth { pose: Some(pose), ..NodeTruth::default() }),
                ..Node::default()
            };
            self.summary.without_value += usize::from(node.pose.is_none());
            graph.nodes.push(node);
        }
        measured.stamps.set(&mut graph.nodes);
    }

    /// Fixes the node of the first prior on the first pose of a robot. A prior on another pose stays a prior.
    fn anchor(&mut self, graph: &mut PoseGraph, measured: &Measured) -> Result<(), ConvertError> {
        let mut first: BTreeMap<Option<char>, u64> = BTreeMap::new();
        for node in &graph.nodes {
            first.entry(robot(node.id)).or_insert(node.id);
        }
        let mut anchored = false;
        for prior in &measured.priors {
            if first.get(&robot(prior.key)) != Some(&prior.key) {
                let found = information(graph.header.dimension, &prior.covariance);
                let information = found.map_err(|problem| {
                    let (problem, remedy) = problem.split_once("; ").unwrap_or((&problem, "correct it"));
                    self.refuse(&prior.place, problem, remedy)
                })?;
                graph.priors.push(Prior {
                    id: graph.priors.len() as u64,
                    node: prior.key,
                    measurement: prior.pose.clone(),
                    information: Some(information),
                    ..Prior::default()
                });
            } else if std::mem::replace(&mut anchored, true) {
                self.summary.priors += 1;
            } else if let Some(node) = graph.nodes.iter_mut().find(|node| node.id == prior.key) {
                node.extra.insert(FIXED.to_owned(), Value::Bool(true));
                if node.pose.is_none() {
                    node.pose = Some(prior.pose.clone());
                    self.summary.without_value -= 1;
                }
            }
        }
        Ok(())
    }

    /// Adds the edges with their kinds and labels.
    fn add_edges(&mut self, graph: &mut PoseGraph, measured: Measured, listed: bool) {
        let Measured { edges, flags, labelled, .. } = measured;
        let ids: BTreeSet<u64> = graph.nodes.iter().map(|node| node.id).collect();
        let (landmarks, mut others): (Vec<_>, Vec<_>) =
            edges.into_iter().zip(flags).partition(|(_, flags)| flags.potential);
        let mut free: Vec<Edge> = others.iter().map(|(edge, _)| edge.clone()).collect();
        // If the dataset lists what may be an outlier, odometry need not be consecutive to be recognised.
        let rule = if listed && self.options.odometry == Odometry::Auto {
            Odometry::NextId
        } else {
            self.options.odometry
        };
        let stated = vec![false; free.len()];
        self.summary.next_ids = set_kinds(rule, &ids, &mut free, &stated);
        for ((edge, _), free) in others.iter_mut().zip(free) {
            *edge = free;
        }
        for (mut edge, flags) in landmarks.into_iter().chain(others) {
            if edge.kind == EdgeKind::Landmark {
                let correct = flags.status.map(|outlier| !outlier).or_else(|| labelled.then_some(true));
                edge.truth = correct.map(EdgeTruth::of);
                self.summary.labelled += usize::from(correct.is_some());
            }
            graph.edges.push(edge);
        }
        graph.edges.sort_by_key(|edge| edge.id);
    }
}

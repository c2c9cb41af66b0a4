//! Summarises a pose graph.

use std::collections::BTreeMap;
use std::fmt;

use posecut_evaluate::edges::{EdgeScores, score};
use posecut_graph::{Edge, EdgeKind, PoseGraph, PriorOf, doubts_of};
use posecut_stage::counted;
use serde::Serialize;
use serde_json::Value;

use crate::parts::parts;

/// The most sessions, noise models and components that the text lists; the JSON has all.
const LISTED: usize = 20;

/// The summary of a graph, as in `--stats`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Info {
    /// The dimension: 2 or 3.
    pub dimension: u64,
    /// Number of nodes.
    pub nodes: usize,
    /// Nodes with an estimate.
    pub posed_nodes: usize,
    /// Nodes with a true pose.
    pub true_poses: usize,
    /// Sessions in the order of their first node.
    pub sessions: Vec<Session>,
    /// Smallest box around the estimates, metres; absent without estimates.
    pub bounding_box: Option<Bounds>,
    /// Odometry edges.
    pub odometry: Edges,
    /// Landmark edges.
    pub landmark: Edges,
    /// Priors; absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub priors: Option<Priors>,
    /// Number of marked edges, by the stage that marked them.
    pub rejected_by: BTreeMap<String, usize>,
    /// Number of edges and priors that use each noise model of the header.
    pub noise_models: BTreeMap<String, usize>,
    /// Connected components over the edges in use.
    pub components: Components,
    /// Precision and recall of the landmark edges in use; absent if no edge's truth is known.
    pub edges: Option<EdgeScores>,
    /// The stages that made the file, oldest first.
    pub provenance: Vec<String>,
    /// Number of records of unknown kind.
    pub unknown_records: usize,
    /// Fields that the format does not define, with the number of records that have them.
    pub unknown_fields: BTreeMap<String, usize>,
}

/// One session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Session {
    /// Its name; empty for nodes without one.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// First and last frame.
    pub frames: Option<(i64, i64)>,
    /// First and last time, microseconds UTC.
    pub times: Option<(i64, i64)>,
}

/// The corners of a box, metres.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Smallest coordinates.
    pub smallest: Vec<f64>,
    /// Largest coordinates.
    pub largest: Vec<f64>,
}

/// Edges of one kind.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Edges {
    /// Number of edges.
    pub count: usize,
    /// Number of edges that no stage has rejected.
    pub in_use: usize,
    /// Number of edges without a measurement.
    pub unmeasured: usize,
    /// Number of edges between two sessions.
    pub between_sessions: usize,
}

/// Measurements of single nodes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Priors {
    /// Number of priors.
    pub count: usize,
    /// Number of priors that no stage has rejected.
    pub in_use: usize,
    /// Number of priors of a whole pose; the others measure a position.
    pub poses: usize,
    /// Number of marked priors, by the stage that marked them.
    pub rejected_by: BTreeMap<String, usize>,
}

/// Connected components.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Components {
    /// Number of components.
    pub count: usize,
    /// Number of nodes of each component, largest first.
    pub sizes: Vec<usize>,
}

impl Info {
    /// Summarises a graph. O(size), with a logarithmic factor if ids do not count from 0.
    pub fn of(graph: &PoseGraph) -> Self {
        let mut rejected_by = BTreeMap::new();
        let mut noise_models: BTreeMap<String, usize> =
            graph.header.noise_models.iter().map(|(name, _)| (name.clone(), 0)).collect();
        for edge in &graph.edges {
            if let Some(stage) = &edge.rejected_by {
                *rejected_by.entry(stage.clone()).or_default() += 1;
            }
            if let Some(noise) = &edge.noise {
                *noise_models.entry(noise.clone()).or_default() += 1;
            }
        }
        for noise in graph.priors.iter().filter_map(|prior| prior.noise.as_ref()) {
            *noise_models.entry(noise.clone()).or_default() += 1;
        }
        let mut sizes: Vec<usize> = parts(graph).iter().map(|part| part.nodes.len()).collect();
        sizes.sort_unstable_by(|a, b| b.cmp(a));
        Self {
            dimension: graph.header.dimension.number(),
            nodes: graph.nodes.len(),
            posed_nodes: graph.nodes.iter().filter(|node| node.pose.is_some()).count(),
            true_poses: graph
                .nodes
                .iter()
                .filter(|node| node.truth.as_ref().is_some_and(|t| t.pose.is_some()))
                .count(),
            sessions: sessions(graph),
            bounding_box: bounding_box(graph),
            odometry: edges(graph, EdgeKind::Odometry),
            landmark: edges(graph, EdgeKind::Landmark),
            priors: priors(graph),
            rejected_by,
            noise_models,
            components: Components { count: sizes.len(), sizes },
            edges: score(graph),
            provenance: graph.header.provenance.iter().map(provenance_line).collect(),
            unknown_records: graph.unknown.len(),
            unknown_fields: unknown_fields(graph),
        }
    }
}

fn sessions(graph: &PoseGraph) -> Vec<Session> {
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut sessions: Vec<Session> = Vec::new();
    let widen = |range: &mut Option<(i64, i64)>, value: Option<i64>| {
        if let Some(value) = value {
            let (first, last) = range.unwrap_or((value, value));
            *range = Some((first.min(value), last.max(value)));
        }
    };
    for node in &graph.nodes {
        let name = node.session.as_deref().unwrap_or_default();
        let place = *places.entry(name).or_insert_with(|| {
            sessions.push(Session { name: name.to_owned(), nodes: 0, frames: None, times: None });
            sessions.len() - 1
        });
        sessions[place].nodes += 1;
        widen(&mut sessions[place].frames, node.frame);
        widen(&mut sessions[place].times, node.utime);
    }
    sessions
}

fn bounding_box(graph: &PoseGraph) -> Option<Bounds> {
    let axes = graph.header.dimension.number() as usize;
    let mut poses = graph.nodes.iter().filter_map(|node| node.pose.as_ref());
    let first = poses.next()?[..axes].to_vec();
    let mut bounds = Bounds { smallest: first.clone(), largest: first };
    for pose in poses {
        let sides = bounds.smallest.iter_mut().zip(&mut bounds.largest);
        for ((smallest, largest), &coordinate) in sides.zip(pose) {
            *smallest = smallest.min(coordinate);
            *largest = largest.max(coordinate);
        }
    }
    Some(bounds)
}

fn edges(graph: &PoseGraph, kind: EdgeKind) -> Edges {
    let session = |id| graph.node_index(id).and_then(|index| graph.nodes[index].session.as_deref());
    let mut edges = Edges::default();
    for edge in graph.edges_of(kind) {
        edges.count += 1;
        edges.in_use += usize::from(edge.in_use());
        edges.unmeasured += usize::from(edge.measurement.is_none());
        edges.between_sessions += usize::from(session(edge.from) != session(edge.to));
    }
    edges
}

fn priors(graph: &PoseGraph) -> Option<Priors> {
    let mut priors = Priors::default();
    for prior in &graph.priors {
        priors.count += 1;
        priors.in_use += usize::from(prior.in_use());
        priors.poses += usize::from(prior.of(graph.header.dimension) == Some(PriorOf::Pose));
        if let Some(stage) = &prior.rejected_by {
            *priors.rejected_by.entry(stage.clone()).or_default() += 1;
        }
    }
    (priors.count > 0).then_some(priors)
}

fn unknown_fields(graph: &PoseGraph) -> BTreeMap<String, usize> {
    let mut fields = BTreeMap::new();
    let mut count = |kind: &str, extra: &posecut_graph::Extra| {
        for name in extra.keys() {
            *fields.entry(format!("{kind}.{name}")).or_default() += 1;
        }
    };
    count("header", &graph.header.extra);
    for node in &graph.nodes {
        count("node", &node.extra);
        node.truth.iter().for_each(|truth| count("node.truth", &truth.extra));
    }
    for edge in &graph.edges {
        count(edge.kind.name(), &edge.extra);
        let truth = |edge: &Edge| format!("{}.truth", edge.kind.name());
        edge.truth.iter().for_each(|known| count(&truth(edge), &known.extra));
    }
    for prior in &graph.priors {
        count("prior", &prior.extra);
        prior.truth.iter().for_each(|truth| count("prior.truth", &truth.extra));
    }
    fields
}

/// An entry of the history in one line: the stage, its version, the arguments that are not null, and its doubts.
pub fn provenance_line(entry: &Value) -> String {
    let text = |value: &Value| match value {
        Value::String(text) => text.clone(),
        other => other.to_string(),
    };
    let Some(stage) = entry.get("stage") else { return format!("unknown layout: {entry}") };
    let mut line = text(stage);
    if let Some(version) = entry.get("version") {
        line = format!("{line} {}", text(version));
    }
    if let Some(Value::Object(arguments)) = entry.get("arguments") {
        for (name, value) in arguments.iter().filter(|(_, value)| !value.is_null()) {
            line = format!("{line} {name}={}", text(value));
        }
    }
    let doubts: Vec<&str> = doubts_of(entry).collect();
    if !doubts.is_empty() {
        line = format!("{line} (doubts: {})", doubts.join(", "));
    }
    line
}

impl fmt::Display for Info {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "dimension    {}", self.dimension)?;
        writeln!(
            out,
            "nodes        {} ({} with pose, {} with true pose)",
            self.nodes, self.posed_nodes, self.true_poses
        )?;
        for session in self.sessions.iter().take(LISTED) {
            let name = if session.name.is_empty() { "(no session)" } else { &session.name };
            write!(out, "session      {name}: {}", counted(session.nodes, "node"))?;
            if let Some((first, last)) = session.frames {
                write!(out, ", frames {first} to {last}")?;
            }
            if let Some((first, last)) = session.times {
                write!(out, ", {:.1} s", (last as f64 - first as f64) * 1e-6)?;
            }
            writeln!(out)?;
        }
        more(out, self.sessions.len(), "session")?;
        if let Some(bounds) = &self.bounding_box {
            write!(out, "bounding box")?;
            for (name, (low, high)) in ["x", "y", "z"].iter().zip(bounds.smallest.iter().zip(&bounds.largest))
            {
                write!(out, " {name} {low:.3} to {high:.3} m")?;
            }
            writeln!(out)?;
        }
        for (name, edges) in [("odometry", &self.odometry), ("landmark", &self.landmark)] {
            let count = counted(edges.count, "edge");
            writeln!(
                out,
                "{name:12} {count} ({} in use, {} without measurement, {} between sessions)",
                edges.in_use, edges.unmeasured, edges.between_sessions
            )?;
        }
        for (stage, count) in &self.rejected_by {
            writeln!(out, "rejected     {count} by {stage}")?;
        }
        if let Some(priors) = &self.priors {
            writeln!(out, "priors       {priors}")?;
        }
        if let Some(scores) = &self.edges {
            let share = |share: Option<f64>| share.map_or("none".to_owned(), |share| format!("{share:.4}"));
            writeln!(
                out,
                "truth        precision {}, recall {} ({} correct in use, {} incorrect in use, {} correct rejected, {} incorrect rejected)",
                share(scores.precision),
                share(scores.recall),
                scores.true_positive,
                scores.false_positive,
                scores.false_negative,
                scores.true_negative
            )?;
        }
        for (name, count) in self.noise_models.iter().take(LISTED) {
            writeln!(out, "noise model  {name}: {}", counted(*count, "edge"))?;
        }
        more(out, self.noise_models.len(), "noise model")?;
        let sizes: Vec<String> = self.components.sizes.iter().take(LISTED).map(ToString::to_string).collect();
        let rest = if self.components.count > LISTED { ", …" } else { "" };
        writeln!(out, "components   {} (nodes: {}{rest})", self.components.count, sizes.join(", "))?;
        for (name, count) in &self.unknown_fields {
            writeln!(out, "unknown      field {name} in {}", counted(*count, "record"))?;
        }
        if self.unknown_records > 0 {
            writeln!(out, "unknown      {} of other kinds", counted(self.unknown_records, "record"))?;
        }
        for (place, line) in self.provenance.iter().enumerate() {
            writeln!(out, "made by      {}. {line}", place + 1)?;
        }
        Ok(())
    }
}

impl fmt::Display for Priors {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, in_use, poses, rejected_by } = self;
        write!(out, "{count} ({in_use} in use, {poses} of poses, {} of positions", count - poses)?;
        for (stage, count) in rejected_by {
            write!(out, ", {count} rejected by {stage}")?;
        }
        write!(out, ")")
    }
}

fn more(out: &mut fmt::Formatter<'_>, count: usize, what: &str) -> fmt::Result {
    if count > LISTED {
        writeln!(out, "             and {}", counted(count - LISTED, &format!("further {what}")))
    } else {
        Ok(())
    }
}

//! Checks whether a pose graph is sound.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt;
use std::io::BufRead;

use posecut_geometry::covariance::{CovarianceError, covariance_from_information, unpack_upper_triangle};
use posecut_graph::{
    Dimension, Edge, EdgeKind, Examination, FormatProblem, PoseGraph, Prior, PriorOf, ReadError, examine,
};
use posecut_stage::counted;
use serde::Serialize;

use crate::parts::parts;

/// Whether a finding makes a file invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Every stage refuses the file.
    Fault,
    /// Stages accept it, but it is probably a mistake.
    Warning,
}

/// One error or warning.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// The line, from 1; 0 if the finding is about the whole file.
    pub line: u64,
    /// The record, such as `landmark 2574`.
    pub record: Option<String>,
    /// The field.
    pub field: Option<String>,
    /// What is wrong.
    pub problem: String,
    /// What to do about it.
    pub remedy: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let severity = if self.severity == Severity::Fault { "error" } else { "warning" };
        write!(out, "{severity}: ")?;
        let mut place = Vec::new();
        if self.line > 0 {
            place.push(format!("line {}", self.line));
        }
        place.extend(self.record.clone());
        place.extend(self.field.as_ref().map(|field| format!("field \"{field}\"")));
        if !place.is_empty() {
            write!(out, "{}: ", place.join(", "))?;
        }
        write!(out, "{}; {}", self.problem, self.remedy)
    }
}

/// All findings about a file: errors in the order of lines, then errors that concern several records, then warnings.
/// Returns an error only if the bytes cannot be read. O(size), with a logarithmic factor if ids do not count from 0.
pub fn validate(source_name: &str, reader: impl BufRead) -> Result<Vec<Finding>, ReadError> {
    let Examination { graph, node_lines, edge_lines, prior_lines, faults } = examine(source_name, reader)?;
    let mut findings: Vec<Finding> = faults.into_iter().map(fault).collect();
    if let Some(graph) = graph {
        let mut warnings = Warnings { graph: &graph, node_lines, edge_lines, prior_lines, found: Vec::new() };
        warnings.order();
        warnings.sessions();
        warnings.measurements();
        warnings.connection();
        warnings.names();
        warnings.found.sort_by_key(|finding| finding.line);
        findings.extend(warnings.found);
    }
    Ok(findings)
}

fn fault(problem: FormatProblem) -> Finding {
    Finding {
        severity: Severity::Fault,
        line: problem.line,
        record: problem.record,
        field: problem.field,
        problem: problem.problem,
        remedy: problem.remedy,
    }
}

struct Warnings<'a> {
    graph: &'a PoseGraph,
    node_lines: Vec<u64>,
    edge_lines: Vec<u64>,
    prior_lines: Vec<u64>,
    found: Vec<Finding>,
}

impl Warnings<'_> {
    fn warn(
        &mut self,
        line: u64,
        record: Option<String>,
        field: Option<&str>,
        problem: String,
        remedy: &str,
    ) {
        self.found.push(Finding {
            severity: Severity::Warning,
            line,
            record,
            field: field.map(str::to_owned),
            problem,
            remedy: remedy.to_owned(),
        });
    }

    /// Warns of descending ids, and of edges before nodes: the canonical form has neither.
    fn order(&mut self) {
        let falls = |lines: &[u64]| lines.windows(2).find(|pair| pair[0] > pair[1]).map(|pair| pair[1]);
        for (what, line) in [
            ("nodes", falls(&self.node_lines)),
            ("edges", falls(&self.edge_lines)),
            ("priors", falls(&self.prior_lines)),
        ] {
            if let Some(line) = line {
                let problem = format!("the {what} are not in the order of their ids");
                self.warn(
                    line,
                    None,
                    Some("id"),
                    problem,
                    "posecut-inspect filter without options writes them in order",
                );
            }
        }
        if let (Some(&last), Some(&first)) = (self.node_lines.iter().max(), self.edge_lines.iter().min())
            && first < last
        {
            let problem = "an edge comes before the last node".to_owned();
            self.warn(
                first,
                None,
                None,
                problem,
                "posecut-inspect filter without options writes all nodes first",
            );
        }
    }

    /// Warns of nodes without a pose, repeated frames and descending times, session by session.
    fn sessions(&mut self) {
        let graph = self.graph;
        let mut by_session: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (index, node) in graph.nodes.iter().enumerate() {
            by_session.entry(node.session.as_deref().unwrap_or_default()).or_default().push(index);
        }
        for nodes in by_session.values() {
            let mut frames: HashMap<i64, u64> = HashMap::new();
            let mut last: Option<(i64, u64)> = None;
            for &index in nodes {
                let (node, line) = (&graph.nodes[index], self.node_lines[index]);
                let name = Some(format!("node {}", node.id));
                if let Some(frame) = node.frame
                    && let Some(other) = frames.insert(frame, node.id)
                {
                    let problem = format!("node {other} of the same session has frame {frame} too");
                    self.warn(
                        line,
                        name.clone(),
                        Some("frame"),
                        problem,
                        "give each node of a session a frame of its own: support edges are counted in frames",
                    );
                }
                if let Some(time) = node.utime {
                    if let Some((before, other)) = last.filter(|&(before, _)| time < before) {
                        let problem = format!("its time {time} is before {before}, the time of node {other}");
                        self.warn(
                            line,
                            name,
                            Some("utime"),
                            problem,
                            "number the nodes of a session in the order of time",
                        );
                    }
                    last = Some((time, node.id));
                }
            }
        }
        let posed = graph.nodes.iter().filter(|node| node.pose.is_some()).count();
        if posed > 0 && posed < graph.nodes.len() {
            let index = graph.nodes.iter().position(|node| node.pose.is_none()).unwrap_or_default();
            let name = format!("node {}", graph.nodes[index].id);
            let problem = format!(
                "it is the first of {} without a pose, while others have one",
                counted(graph.nodes.len() - posed, "node")
            );
            self.warn(
                self.node_lines[index],
                Some(name),
                Some("pose"),
                problem,
                "optimise the graph: posecut-optimize gives every node a pose",
            );
        }
    }

    /// Warns of information matrices that are singular or nearly so, quaternions that are not quite of norm 1, and
    /// marks on odometry.
    fn measurements(&mut self) {
        let graph = self.graph;
        for (name, model) in &graph.header.noise_models {
            if let Some(problem) = weakness(graph.header.dimension, &model.information) {
                let field = format!("noise_models.{name}.information");
                self.warn(1, Some("header".to_owned()), Some(&field), problem, WEAK_REMEDY);
            }
        }
        let mut last: (&[f64], Option<String>) = (&[], None);
        let mut pairs: HashMap<(u64, u64), &Edge> = HashMap::new();
        for (index, edge) in graph.edges.iter().enumerate() {
            let line = self.edge_lines[index];
            if let Some(information) = edge.information.as_deref() {
                if information != last.0 {
                    last = (information, weakness(graph.header.dimension, information));
                }
                if let Some(problem) = last.1.clone() {
                    self.warn(line, Some(edge.name()), Some("information"), problem, WEAK_REMEDY);
                }
            }
            if edge.kind == EdgeKind::Odometry && !edge.in_use() {
                let stage = edge.rejected_by.as_deref().unwrap_or_default();
                self.warn(
                    line,
                    Some(edge.name()),
                    Some("rejected_by"),
                    format!("{stage} rejected an odometry edge"),
                    "stages may reject only landmark edges; remove the field",
                );
            }
            if edge.kind == EdgeKind::Odometry && self.session(edge.from) != self.session(edge.to) {
                self.warn(
                    line,
                    Some(edge.name()),
                    Some("to"),
                    "an odometry edge joins two sessions".to_owned(),
                    "make it a landmark edge, or correct its ends",
                );
            }
            if edge.kind == EdgeKind::Landmark
                && edge.in_use()
                && let Some(other) = pairs.insert((edge.from.min(edge.to), edge.from.max(edge.to)), edge)
            {
                let problem = format!("it joins the same nodes as landmark {}", other.id);
                self.warn(
                    line,
                    Some(edge.name()),
                    Some("to"),
                    problem,
                    "keep one, unless these are two measurements",
                );
            }
        }
        if graph.header.dimension == Dimension::Three {
            self.quaternions();
        }
    }

    fn session(&self, id: u64) -> Option<&str> {
        self.graph.node_index(id).and_then(|index| self.graph.nodes[index].session.as_deref())
    }

    fn quaternions(&mut self) {
        let graph = self.graph;
        let poses = graph.nodes.iter().zip(&self.node_lines);
        let poses =
            poses.map(|(node, line)| (node.pose.as_ref(), *line, format!("node {}", node.id), "pose"));
        let edges = graph.edges.iter().zip(&self.edge_lines);
        let edges = edges.map(|(edge, line)| (edge.measurement.as_ref(), *line, edge.name(), "measurement"));
        let of_pose = |prior: &Prior| prior.of(Dimension::Three) == Some(PriorOf::Pose);
        let priors = graph.priors.iter().zip(&self.prior_lines).filter(|(prior, _)| of_pose(prior));
        let priors =
            priors.map(|(prior, line)| (Some(&prior.measurement), *line, prior.name(), "measurement"));
        let off: Vec<_> = poses
            .chain(edges)
            .chain(priors)
            .filter_map(|(pose, line, name, field)| {
                let norm = pose?[3..].iter().map(|component| component * component).sum::<f64>().sqrt();
                ((norm - 1.0).abs() > 1e-9).then_some((line, name, field, norm))
            })
            .collect();
        for (line, name, field, norm) in off {
            self.warn(
                line,
                Some(name),
                Some(field),
                format!("the quaternion has norm {norm}"),
                "it is used unchanged; normalise it in full precision",
            );
        }
    }

    /// Warns of several connected components.
    fn connection(&mut self) {
        let parts = parts(self.graph);
        if parts.len() > 1 {
            let largest = parts.iter().map(|part| part.nodes.len()).max().unwrap_or_default();
            let second = parts[1].nodes[0];
            let problem = format!(
                "it is the first node of the second of {} components that no edge in use joins; the largest has {largest} of {} nodes",
                parts.len(),
                self.graph.nodes.len()
            );
            let name = format!("node {}", self.graph.nodes[second].id);
            self.warn(
                self.node_lines[second],
                Some(name),
                None,
                problem,
                "their relative poses are unknown; posecut-inspect filter --component N extracts one",
            );
        }
    }

    /// Warns of unused noise models, and of history entries without a stage or version.
    fn names(&mut self) {
        let used: BTreeSet<&str> = self.graph.edges.iter().filter_map(|edge| edge.noise.as_deref()).collect();
        let header = &self.graph.header;
        for (name, _) in header.noise_models.iter().filter(|(name, _)| !used.contains(name.as_str())) {
            self.warn(
                1,
                Some("header".to_owned()),
                Some("noise_models"),
                format!("no edge uses the noise model \"{name}\""),
                "remove it, or refer to it in the edges",
            );
        }
        for (place, entry) in header.provenance.iter().enumerate() {
            if entry.get("stage").is_none() || entry.get("version").is_none() {
                self.warn(
                    1,
                    Some("header".to_owned()),
                    Some("provenance"),
                    format!("entry {} has no \"stage\" or no \"version\"", place + 1),
                    "add the program that wrote the file; crates/graph/README.md describes the layout",
                );
            }
        }
    }
}

const WEAK_REMEDY: &str = "give the measurement information in every direction, or omit it";

/// Describes in which component an information matrix is singular to working precision; `None` if it is regular.
fn weakness(dimension: Dimension, terms: &[f64]) -> Option<String> {
    let result = match dimension {
        Dimension::Two => covariance_from_information(&unpack_upper_triangle::<3>(terms).ok()?).map(drop),
        Dimension::Three => covariance_from_information(&unpack_upper_triangle::<6>(terms).ok()?).map(drop),
    };
    match result {
        Ok(()) => None,
        Err(CovarianceError::Singular { index } | CovarianceError::NotPositiveDefinite { index, .. }) => {
            Some(format!(
                "the matrix is singular to working precision: component {} has no information of its own",
                index + 1
            ))
        }
        Err(error) => Some(error.to_string()),
    }
}

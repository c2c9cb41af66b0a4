//! What a page shows.

use posecut_graph::PoseGraph;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::Frame;

/// One graph, and what is known about it.
#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    /// The title of the page, as text.
    pub title: &'a str,
    /// The graph with its final marks and poses.
    pub graph: &'a PoseGraph,
    /// The same nodes with their poses before, by id. Without it, the page computes dead reckoning from the odometry.
    pub before: Option<&'a PoseGraph>,
    /// The `--stats` of posecut-verify: calibration, rivals, broken odometry, joins of components.
    pub statistics: Option<&'a Map<String, Value>>,
    /// What an examination of the graph found.
    pub remarks: &'a [Remark],
    /// The same graph under other hypotheses, by the ids of its nodes and edges.
    pub alternatives: &'a [Alternative<'a>],
    /// How coordinates are drawn.
    pub frame: Frame,
}

impl<'a> View<'a> {
    /// A view of a graph alone.
    pub fn of(graph: &'a PoseGraph) -> Self {
        Self {
            title: "posecut view",
            graph,
            before: None,
            statistics: None,
            remarks: &[],
            alternatives: &[],
            frame: Frame::Auto,
        }
    }
}

/// The same graph with other marks and poses.
#[derive(Clone, Copy, Debug)]
pub struct Alternative<'a> {
    /// What the choice of maps calls it, such as `hypothesis 1`.
    pub name: &'a str,
    /// Its marks and poses. It may lack nodes and edges of the main graph; the page leaves out what the main graph lacks.
    pub graph: &'a PoseGraph,
}

/// Something found in a graph, with its remedy.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remark {
    /// How bad it is.
    pub severity: Severity,
    /// A few words.
    pub title: String,
    /// What was found, with numbers, and what follows from it.
    pub text: String,
    /// What to do; empty if there is nothing to do.
    #[serde(default)]
    pub remedy: String,
}

/// How bad a finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Results are wrong until it is fixed.
    Error,
    /// Results may be wrong.
    Warning,
    /// Good to know.
    Note,
}

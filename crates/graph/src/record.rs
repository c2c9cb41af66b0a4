//! Nodes and edges as files hold them.

use serde_json::Value;

use crate::{Dimension, Extra, Header, Prior};

/// One line of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Record {
    /// The first line.
    Header(Header),
    /// A viewpoint.
    Node(Node),
    /// An odometry or landmark edge.
    Edge(Edge),
    /// A measurement of one node.
    Prior(Prior),
    /// A record of a kind this crate does not know: the line as read, without its end.
    Unknown(String),
}

/// A viewpoint (keyframe).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    /// The id, unique among nodes.
    pub id: u64,
    /// The session (experience) that the node belongs to.
    pub session: Option<String>,
    /// The frame number within the down-sampled session.
    pub frame: Option<i64>,
    /// Microseconds, UTC.
    pub utime: Option<i64>,
    /// The current estimate, world from body.
    pub pose: Option<Vec<f64>>,
    /// The landmark (component of the multicut) that the node belongs to.
    pub landmark: Option<u64>,
    /// The truth, which only construction and evaluation may read.
    pub truth: Option<NodeTruth>,
    /// Unknown fields, passed through.
    pub extra: Extra,
}

/// The truth about a node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeTruth {
    /// The ground-truth pose, world from body.
    pub pose: Option<Vec<f64>>,
    /// Unknown fields, passed through.
    pub extra: Extra,
}

/// The kind of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EdgeKind {
    /// Motion between successive nodes of a session.
    Odometry,
    /// A recognised place: a loop closure, correct or incorrect.
    Landmark,
}

impl EdgeKind {
    /// The value of `"kind"`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Odometry => "odometry",
            Self::Landmark => "landmark",
        }
    }
}

/// A relative measurement between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Edge {
    /// Odometry or landmark.
    pub kind: EdgeKind,
    /// The id, unique among edges of both kinds.
    pub id: u64,
    /// The node in whose frame the measurement is given.
    pub from: u64,
    /// The node that is measured.
    pub to: u64,
    /// The pose of `to` in the frame of `from`. A landmark edge may have none.
    pub measurement: Option<Vec<f64>>,
    /// Upper triangle of the information matrix, row-major.
    pub information: Option<Vec<f64>>,
    /// The name of a noise model in the header, instead of `information`.
    pub noise: Option<String>,
    /// The truth, which only construction and evaluation may read.
    pub truth: Option<EdgeTruth>,
    /// The stage that rejected the edge; absent while it is in use.
    pub rejected_by: Option<String>,
    /// The multicut's cost of cutting the edge.
    pub cost: Option<f64>,
    /// The confidence of the program that proposed the edge.
    pub score: Option<f64>,
    /// Unknown fields, passed through.
    pub extra: Extra,
}

impl Edge {
    /// An edge without a measurement.
    pub fn new(kind: EdgeKind, id: u64, from: u64, to: u64) -> Self {
        Self {
            kind,
            id,
            from,
            to,
            measurement: None,
            information: None,
            noise: None,
            truth: None,
            rejected_by: None,
            cost: None,
            score: None,
            extra: Extra::new(),
        }
    }

    /// Whether the edge is in use: no stage has rejected it.
    pub fn in_use(&self) -> bool {
        self.rejected_by.is_none()
    }

    /// Marks the edge as rejected by a stage. If the edge is already rejected, the earlier stage's name stays.
    pub fn reject(&mut self, stage: &str) {
        self.rejected_by.get_or_insert_with(|| stage.to_owned());
    }

    /// Removes the mark of rejection, whichever stage made it.
    pub fn readmit(&mut self) {
        self.rejected_by = None;
    }

    /// Whether the edge is correct by its truth; `None` if that is unknown.
    pub fn truth_correct(&self) -> Option<bool> {
        self.truth.as_ref().and_then(|truth| truth.correct)
    }

    /// Kind and id, as messages name the edge.
    pub fn name(&self) -> String {
        format!("{} {}", self.kind.name(), self.id)
    }
}

/// The truth about an edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EdgeTruth {
    /// Whether its two nodes really see the same place.
    pub correct: Option<bool>,
    /// Unknown fields, passed through.
    pub extra: Extra,
}

impl EdgeTruth {
    /// The truth with only this label.
    pub fn of(correct: bool) -> Self {
        Self { correct: Some(correct), extra: Extra::new() }
    }
}

/// The field that says whether a node stays at its pose (g2o's `FIX`): true or false.
pub const FIXED: &str = "fixed";

impl Node {
    /// Whether the node stays at its pose. If the field is neither true nor false, its value is the error.
    pub fn is_fixed(&self) -> Result<bool, &Value> {
        match self.extra.get(FIXED) {
            None | Some(Value::Null) => Ok(false),
            Some(Value::Bool(fixed)) => Ok(*fixed),
            Some(other) => Err(other),
        }
    }

    /// Session and frame, by which stages that work with sequences find neighbours; `None` without both.
    pub fn session_frame(&self) -> Option<(&str, i64)> {
        Some((self.session.as_deref()?, self.frame?))
    }

    /// The estimate; the identity of that dimension if there is none.
    pub fn pose_or_identity(&self, dimension: Dimension) -> Vec<f64> {
        self.pose.clone().unwrap_or_else(|| dimension.identity())
    }
}

//! Whether each landmark edge is in use, undecided or rejected, and by which stage.

use posecut_graph::{Edge, EdgeKind, PoseGraph};
use serde::Serialize;

use crate::encode::differences;

/// The stage that calls edges undecided.
const VERIFY: &str = "verify";

/// What became of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// It is in use.
    Kept,
    /// Nothing supports it enough, and nothing contradicts it, whether it is in use or not.
    Undecided,
    /// A stage rejected it.
    Rejected,
    /// The map has no such edge.
    Absent,
}

/// A state, as legends name it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub(crate) struct State {
    kind: Kind,
    name: String,
}

impl State {
    fn of(edge: Option<&Edge>) -> Self {
        let Some(edge) = edge else { return Self { kind: Kind::Absent, name: "not in this map".to_owned() } };
        let undecided =
            edge.extra.get("verify_verdict").and_then(|verdict| verdict.as_str()) == Some("undecided");
        let (kind, name) = match edge.rejected_by.as_deref() {
            None if undecided => (Kind::Undecided, "undecided (in use)".to_owned()),
            None if edge.measurement.is_none() => (Kind::Kept, "in use, without measurement".to_owned()),
            None => (Kind::Kept, "in use".to_owned()),
            Some(VERIFY) if undecided => (Kind::Undecided, "undecided (not in use)".to_owned()),
            Some(stage) => (Kind::Rejected, format!("rejected by {}", crate::columns::shortened(stage))),
        };
        Self { kind, name }
    }
}

/// What became of a landmark edge, without the stage that decided it.
pub fn kind(edge: &Edge) -> Kind {
    State::of(Some(edge)).kind
}

/// The state of each edge.
#[derive(Debug, Serialize)]
pub(crate) struct States {
    /// The states that occur: kept ones first.
    states: Vec<State>,
    /// For each edge the index of its state.
    state: String,
}

impl States {
    pub(crate) fn of(edges: &[Option<&Edge>]) -> Self {
        let own: Vec<State> = edges.iter().map(|edge| State::of(*edge)).collect();
        let mut states = own.clone();
        states.sort();
        states.dedup();
        let index = own.iter().map(|state| states.binary_search(state).map_or(0, |found| found as i64));
        let state = differences(index);
        Self { states, state }
    }
}

/// How many landmark edges a page shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Summary {
    /// All landmark edges.
    pub landmark_edges: usize,
    /// In use, and not undecided.
    pub in_use: usize,
    /// Undecided, in use or not.
    pub undecided: usize,
    /// Rejected by a stage.
    pub rejected: usize,
}

/// Counts the landmark edges of a graph by what became of them.
pub fn summary(graph: &PoseGraph) -> Summary {
    let mut summary = Summary::default();
    for edge in graph.edges_of(EdgeKind::Landmark) {
        summary.landmark_edges += 1;
        *match State::of(Some(edge)).kind {
            Kind::Kept | Kind::Absent => &mut summary.in_use,
            Kind::Undecided => &mut summary.undecided,
            Kind::Rejected => &mut summary.rejected,
        } += 1;
    }
    summary
}

//! The page's data, in the form that its scripts read. Lengths are in metres; series are texts of [`posecut_view::encode`].

use serde::Serialize;

use super::maps::LogMaps;
use crate::figure::regret::Regrets;
use crate::regimes::Map;
use crate::trust::reliability::Reliability;

/// Drawn positions are rounded to this, metres.
pub const POSITION_STEP: f64 = 0.1;

/// Drawn errors are rounded to this, metres.
pub const ERROR_STEP: f64 = 0.01;

/// All data of the page.
#[derive(Clone, Debug, Serialize)]
pub struct Page {
    /// One entry for each label `pipeline`.
    pub experiments: Vec<Experiment>,
    /// Maps of laser logs.
    pub maps: Vec<LogMaps>,
    /// The map of regimes, if there is one.
    pub regimes: Option<Map>,
    /// The regret of every run of the trust benchmark, if there are results of it.
    pub trust: Option<Regrets>,
    /// How well the benchmark's probabilities are calibrated, if a method writes any.
    pub reliability: Option<Reliability>,
    /// The step of positions, metres.
    pub position_step: f64,
    /// The step of positions on maps of laser logs, metres.
    pub map_step: f64,
    /// The step of errors, metres.
    pub error_step: f64,
    /// The names of the axes of drawn coordinates: to the right, upwards.
    pub axes: [&'static str; 2],
}

/// One experiment.
#[derive(Clone, Debug, Serialize)]
pub struct Experiment {
    /// Its name.
    pub name: String,
    /// Methods in the order of rows.
    pub methods: Vec<String>,
    /// RMSE of every run.
    pub spread: Vec<Spread>,
    /// Sessions whose graphs were found.
    pub sessions: Vec<Session>,
}

/// The runs of a method on a session.
#[derive(Clone, Debug, Serialize)]
pub struct Spread {
    /// The session.
    pub session: String,
    /// The method.
    pub method: String,
    /// Pairs of seed and RMSE, metres, unrounded.
    pub rmse: Vec<(String, f64)>,
    /// The published value, metres.
    pub published: Option<f64>,
}

/// A session's graphs.
#[derive(Clone, Debug, Serialize)]
pub struct Session {
    /// Its name.
    pub name: String,
    /// The trajectory by ground truth.
    pub truth: Option<Track>,
    /// Minutes since the session's first node, in steps of a hundredth; absent unless time increases steadily.
    pub minutes: Option<String>,
    /// The drawn runs.
    pub seeds: Vec<Seed>,
}

/// Positions of all nodes in their order.
#[derive(Clone, Debug, Serialize)]
pub struct Track {
    /// To the right on paper.
    pub right: String,
    /// Upwards on paper.
    pub up: String,
}

/// One constructed graph, and the result of each method on it.
#[derive(Clone, Debug, Serialize)]
pub struct Seed {
    /// The seed.
    pub name: String,
    /// Stretches of nodes that belong to one experience.
    pub experiences: Vec<Experience>,
    /// The trajectory that estimates are compared with.
    pub reference: Option<Track>,
    /// The landmark edges.
    pub edges: Edges,
    /// Which landmark edges agree with each other.
    pub consistency: Option<Consistency>,
    /// One entry a method.
    pub methods: Vec<Method>,
}

/// Nodes `start` to `end` (not included).
#[derive(Clone, Debug, Serialize)]
pub struct Experience {
    /// Its name.
    pub name: String,
    /// The first node.
    pub start: usize,
    /// The node after its last.
    pub end: usize,
}

/// Landmark edges, one entry each in all lists.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Edges {
    /// Ids.
    pub id: Vec<u64>,
    /// Indices of the nodes in the graph.
    pub from: Vec<usize>,
    /// Indices of the nodes in the graph.
    pub to: Vec<usize>,
    /// Frames of the nodes.
    pub frames: Vec<(i64, i64)>,
    /// `t` correct, `f` incorrect, `?` unknown.
    pub truth: String,
}

/// The consistency matrix of PCM's candidates.
#[derive(Clone, Debug, Serialize)]
pub struct Consistency {
    /// Indices into the list of edges.
    pub edges: Vec<usize>,
    /// The group of each candidate, that is, the pair of chains that it joins. Candidates of different groups are not
    /// compared.
    pub group: Vec<usize>,
    /// Whether each candidate is in the clique.
    pub clique: String,
    /// The upper triangle without the diagonal, row by row, as bits.
    pub pairs: String,
    /// The condition for a consistent pair, in words.
    pub gate: String,
    /// The method that ran this PCM.
    pub method: String,
}

/// An estimate.
#[derive(Clone, Debug, Serialize)]
pub struct Method {
    /// Its name.
    pub name: String,
    /// RMSE of the result, metres, unrounded.
    pub rmse: f64,
    /// Components of the graph of edges in use.
    pub components: usize,
    /// The estimated trajectory, aligned to the reference.
    pub track: Option<Track>,
    /// Distance of each node from the reference.
    pub error: Option<String>,
    /// For each edge: `+` in use, `-` dropped, or the letter of the stage that rejected it: `a` for the first of
    /// `stages`.
    pub state: String,
    /// Stages that rejected edges.
    pub stages: Vec<String>,
    /// Node indices of each landmark of several viewpoints, largest first.
    pub landmarks: Option<Vec<Vec<usize>>>,
}

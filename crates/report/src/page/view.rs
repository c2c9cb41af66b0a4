//! The page's data, as its scripts read it. Lengths are metres; series are texts of [`super::encode`].

use serde::Serialize;

use crate::figure::regret::Regrets;
use crate::regimes::Map;
use crate::trust::reliability::Reliability;

/// Metres to which drawn positions are rounded.
pub const POSITION_STEP: f64 = 0.1;

/// Metres to which drawn errors are rounded.
pub const ERROR_STEP: f64 = 0.01;

/// All of it.
#[derive(Clone, Debug, Serialize)]
pub struct Page {
    /// One entry for each label `pipeline`.
    pub experiments: Vec<Experiment>,
    /// The map of regimes, if there is one.
    pub regimes: Option<Map>,
    /// The regret of every run of the trust benchmark, if there are results of it.
    pub trust: Option<Regrets>,
    /// How well its probabilities are calibrated, if a method writes any.
    pub reliability: Option<Reliability>,
    /// Metres a step of positions.
    pub position_step: f64,
    /// Metres a step of errors.
    pub error_step: f64,
    /// What the axes of drawn coordinates are called: to the right, upwards.
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
    /// RMSE by seed, metres, unrounded.
    pub rmse: Vec<(String, f64)>,
    /// The published value, metres.
    pub published: Option<f64>,
}

/// A session's graphs.
#[derive(Clone, Debug, Serialize)]
pub struct Session {
    /// Its name.
    pub name: String,
    /// Where it went by ground truth.
    pub truth: Option<Track>,
    /// Minutes since its first node, in steps of a hundredth; absent where time does not run on steadily.
    pub minutes: Option<String>,
    /// The runs that are drawn.
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

/// One constructed graph and what became of it.
#[derive(Clone, Debug, Serialize)]
pub struct Seed {
    /// The seed.
    pub name: String,
    /// Stretches of nodes that belong to one experience.
    pub experiences: Vec<Experience>,
    /// What estimates are compared with.
    pub reference: Option<Track>,
    /// The landmark edges.
    pub edges: Edges,
    /// Which of them agree with each other.
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
    /// Places of nodes in the graph.
    pub from: Vec<usize>,
    /// Places of nodes in the graph.
    pub to: Vec<usize>,
    /// Frames of the nodes.
    pub frames: Vec<(i64, i64)>,
    /// `t` correct, `f` incorrect, `?` unknown.
    pub truth: String,
}

/// The consistency matrix of PCM's candidates.
#[derive(Clone, Debug, Serialize)]
pub struct Consistency {
    /// Places in the list of edges.
    pub edges: Vec<usize>,
    /// The pair of chains each candidate joins; pairs of different groups are not compared.
    pub group: Vec<usize>,
    /// Whether each is in the clique.
    pub clique: String,
    /// The upper triangle row by row, without the diagonal, as bits.
    pub pairs: String,
    /// When a pair is consistent, in words.
    pub gate: String,
    /// The method whose PCM it is.
    pub method: String,
}

/// An estimate.
#[derive(Clone, Debug, Serialize)]
pub struct Method {
    /// Its name.
    pub name: String,
    /// RMSE of the result, metres, unrounded.
    pub rmse: f64,
    /// Parts that no edge in use joins.
    pub components: usize,
    /// Where it put the nodes, aligned to the reference.
    pub track: Option<Track>,
    /// Distance of each node from the reference.
    pub error: Option<String>,
    /// For each edge: `+` in use, `-` dropped, or a letter: `a` for the first of `stages`.
    pub state: String,
    /// Stages that rejected edges.
    pub stages: Vec<String>,
    /// Places of the nodes of each landmark of several viewpoints, largest first.
    pub landmarks: Option<Vec<Vec<usize>>>,
}

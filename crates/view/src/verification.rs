//! What posecut-verify says about a graph as a whole, from its `--stats`. Whatever is missing or of another layout is left out:
//! the file may come from another version.

use std::collections::BTreeSet;

use posecut_graph::PoseGraph;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::chains::chains;

/// The counts that the page shows, with their names for readers.
const COUNTS: [(&str, &str); 8] = [
    ("candidates", "landmark edges judged"),
    ("accepted", "accepted"),
    ("contradicted", "contradicted"),
    ("undecided", "undecided"),
    ("unmeasured", "not judged: no measurement"),
    ("rejected_before", "not judged: rejected by an earlier stage"),
    ("joins_proposed", "joins of components that landmark edges propose"),
    ("joins_established", "joins of components that accepted edges make"),
];

/// The statistics of a verification.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Verification {
    counts: Vec<(&'static str, f64)>,
    calibration: Option<Calibration>,
    rivals: Vec<Rival>,
    #[serde(skip)]
    broken: BTreeSet<u64>,
}

/// Factors on covariances.
#[derive(Debug, Serialize)]
struct Calibration {
    chains: Vec<Chain>,
    /// Of landmark edges.
    landmark: Option<f64>,
    /// Estimated share of candidates that measure what is there.
    share: Option<f64>,
    /// Of the loops, above that of shuffled ones, nats.
    evidence: Option<f64>,
    on_prior: bool,
}

#[derive(Debug, Serialize)]
struct Chain {
    name: String,
    /// The factor on the covariance of its odometry.
    odometry: Option<f64>,
    /// The standard deviation of its coherent error, as a share of the distance travelled.
    coherent: Option<f64>,
}

#[derive(Debug, Serialize)]
struct Rival {
    hypothesis: Option<f64>,
    edges: Option<f64>,
    evidence: Option<f64>,
    accepted: Option<f64>,
}

impl Verification {
    pub(crate) fn of(graph: &PoseGraph, statistics: &Map<String, Value>) -> Self {
        let number = |value: &Value, name: &str| value.get(name).and_then(Value::as_f64);
        let list = |name: &str| statistics.get(name).and_then(Value::as_array).into_iter().flatten();
        let mut found = Self {
            counts: COUNTS
                .iter()
                .filter_map(|(field, name)| Some((*name, statistics.get(*field)?.as_f64()?)))
                .collect(),
            calibration: None,
            rivals: list("rivals")
                .map(|rival| Rival {
                    hypothesis: number(rival, "hypothesis"),
                    edges: number(rival, "edges"),
                    evidence: number(rival, "evidence"),
                    accepted: number(rival, "accepted"),
                })
                .collect(),
            broken: list("broken_odometry").filter_map(Value::as_u64).collect(),
        };
        found.calibration =
            statistics.get("calibration").filter(|value| value.is_object()).map(|calibration| {
                let numbers = |name: &str| -> Vec<Option<f64>> {
                    let list = calibration.get(name).and_then(Value::as_array);
                    list.into_iter().flatten().map(Value::as_f64).collect()
                };
                let (odometry, coherent) = (numbers("odometry"), numbers("coherent"));
                let names = chains(graph, |id| found.is_broken(id), odometry.len());
                let chains = names.into_iter().zip(odometry).enumerate().map(|(index, (name, odometry))| {
                    Chain { name, odometry, coherent: coherent.get(index).copied().flatten().map(f64::sqrt) }
                });
                Calibration {
                    chains: chains.collect(),
                    landmark: number(calibration, "landmark"),
                    share: number(calibration, "correct"),
                    evidence: number(calibration, "evidence"),
                    on_prior: calibration.get("on_prior").and_then(Value::as_bool).unwrap_or(false),
                }
            });
        found
    }

    /// Whether verification found this odometry edge to be broken.
    pub(crate) fn is_broken(&self, edge: u64) -> bool {
        self.broken.contains(&edge)
    }
}

//! How often the edges of each probability are correct: the counts of a reliability diagram.

use posecut_graph::{EdgeKind, PoseGraph};
use serde::Serialize;
use serde_json::Value;

use crate::EvaluateError;

/// Bins of equal width between 0 and 1.
pub const BINS: usize = 10;

/// The field of a landmark edge with the probability that it is correct; `posecut-verify` writes it.
pub const PROBABILITY: &str = "verify_probability";

/// Landmark edges whose probability and truth are known, by bins of probability. Bin k has the probabilities from k/10
/// up to but excluding (k+1)/10; the last bin includes 1. The values of several runs can be added.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Calibration {
    /// Number of edges in each bin.
    pub edges: [usize; BINS],
    /// The sum of their probabilities.
    pub probability: [f64; BINS],
    /// Number of correct edges among them.
    pub correct: [usize; BINS],
}

/// Counts the landmark edges of a graph; `None` if none has both a probability and a known truth.
///
/// # Errors
/// If a probability is not a number between 0 and 1.
pub fn calibration(graph: &PoseGraph) -> Result<Option<Calibration>, EvaluateError> {
    let mut found = Calibration::default();
    for edge in graph.edges_of(EdgeKind::Landmark) {
        let probability = match edge.extra.get(PROBABILITY) {
            None | Some(Value::Null) => continue,
            Some(value) => value
                .as_f64()
                .filter(|value| (0.0..=1.0).contains(value))
                .ok_or_else(|| EvaluateError::Probability { edge: edge.name(), value: value.to_string() })?,
        };
        let Some(correct) = edge.truth_correct() else { continue };
        let bin = ((probability * BINS as f64) as usize).min(BINS - 1);
        found.edges[bin] += 1;
        found.probability[bin] += probability;
        found.correct[bin] += usize::from(correct);
    }
    Ok(found.edges.iter().any(|&edges| edges > 0).then_some(found))
}

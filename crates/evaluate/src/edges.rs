//! Precision and recall of the landmark edges in use.

use posecut_graph::{EdgeKind, PoseGraph};
use serde::Serialize;

/// Counts and scores of landmark edges. An edge in use is a positive; it is a *true* one if the truth calls it correct.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct EdgeScores {
    /// Correct edges in use.
    pub true_positive: usize,
    /// Incorrect edges in use: false loop closures that were not rejected.
    pub false_positive: usize,
    /// Correct edges rejected.
    pub false_negative: usize,
    /// Incorrect edges rejected.
    pub true_negative: usize,
    /// Share of correct edges among those in use; absent if none is in use.
    pub precision: Option<f64>,
    /// Share of correct edges that are in use; absent if none is correct.
    pub recall: Option<f64>,
}

/// Scores the landmark edges whose truth is known; `None` if there are none.
pub fn score(graph: &PoseGraph) -> Option<EdgeScores> {
    let mut scores = EdgeScores::default();
    for edge in graph.edges_of(EdgeKind::Landmark) {
        match (edge.in_use(), edge.truth_correct()) {
            (true, Some(true)) => scores.true_positive += 1,
            (true, Some(false)) => scores.false_positive += 1,
            (false, Some(true)) => scores.false_negative += 1,
            (false, Some(false)) => scores.true_negative += 1,
            (_, None) => {}
        }
    }
    let share = |part: usize, rest: usize| (part + rest > 0).then(|| part as f64 / (part + rest) as f64);
    scores.precision = share(scores.true_positive, scores.false_positive);
    scores.recall = share(scores.true_positive, scores.false_negative);
    let known = scores.true_positive + scores.false_positive + scores.false_negative + scores.true_negative;
    (known > 0).then_some(scores)
}

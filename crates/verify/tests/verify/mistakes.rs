//! Verdicts beside the truth.

use posecut_graph::{PoseGraph, for_dimension};
use posecut_verify::verdict::Verdict;
use posecut_verify::verify;

/// Numbers of edges.
#[derive(Clone, Copy, Default)]
pub(crate) struct Mistakes {
    pub(crate) correct: usize,
    /// Correct ones that are not accepted.
    pub(crate) lost: usize,
    /// Incorrect ones that are accepted.
    pub(crate) kept: usize,
}

/// The mistakes of verification on a graph with truth.
pub(crate) fn mistakes(graph: &PoseGraph) -> Mistakes {
    let findings = for_dimension!(graph.header.dimension, |G, DOF| verify::<G, DOF>(graph)).unwrap().findings;
    let mut found = Mistakes::default();
    for finding in findings {
        let is_correct = graph.edges[finding.edge].truth_correct().unwrap();
        let is_accepted = finding.verdict == Verdict::Accepted;
        found.correct += usize::from(is_correct);
        found.lost += usize::from(is_correct && !is_accepted);
        found.kept += usize::from(!is_correct && is_accepted);
    }
    found
}

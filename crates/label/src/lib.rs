//! Labels for landmark edges: which of them are correct.
//!
//! Labels come from exactly one source: a table of labels ([`table`]), a list of the correct pairs ([`pairs`]), one
//! answer for all edges, or ground-truth poses ([`ground_truth`]). Without a source the labels in the file are checked:
//! every landmark edge must have one. A label without an edge and an edge without a label are errors, so that the labels
//! of another graph are not used by mistake.
//!
//! The library works on graphs and bytes; [`stage`], the program, reads the files.

#[cfg(feature = "cli")]
pub mod cli;
pub mod ground_truth;
pub mod pairs;
#[cfg(feature = "cli")]
pub mod stage;
pub mod table;

use std::collections::HashMap;

use anyhow::bail;
use posecut_graph::{Edge, EdgeKind, EdgeTruth, PoseGraph};

/// Labels every landmark edge correct.
pub fn all_correct(graph: &mut PoseGraph) {
    landmarks(graph).for_each(|edge| set(edge, true));
}

/// Replaces every landmark measurement by the identity: "the same place", as from a recogniser without geometry.
pub fn zero_measurements(graph: &mut PoseGraph) {
    let identity = graph.header.dimension.identity();
    landmarks(graph).for_each(|edge| edge.measurement = Some(identity.clone()));
}

fn landmarks(graph: &mut PoseGraph) -> impl Iterator<Item = &mut Edge> {
    graph.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark)
}

/// Sets the label of an edge and keeps the other fields of `truth`.
pub(crate) fn set(edge: &mut Edge, correct: bool) {
    match &mut edge.truth {
        Some(truth) => truth.correct = Some(correct),
        none => *none = Some(EdgeTruth::of(correct)),
    }
}

/// An edge in words for messages: its kind, id and ends.
pub(crate) fn described(edge: &Edge) -> String {
    format!("{} ({} {})", edge.name(), edge.from, edge.to)
}

/// The positions of landmark edges by their ends, in the direction of the file.
pub(crate) fn by_ends(graph: &PoseGraph) -> HashMap<(u64, u64), Vec<usize>> {
    let mut positions: HashMap<(u64, u64), Vec<usize>> = HashMap::new();
    for (position, edge) in graph.edges.iter().enumerate() {
        if edge.kind == EdgeKind::Landmark {
            positions.entry((edge.from, edge.to)).or_default().push(position);
        }
    }
    positions
}

/// Refuses a graph in which a landmark edge has no label.
pub fn check_labels(graph: &PoseGraph) -> anyhow::Result<()> {
    let mut unknown = graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.truth_correct().is_none());
    if let Some(first) = unknown.next() {
        bail!(
            "there is no label \"truth\":{{\"correct\":…}} on {} of {} landmark edges (first: {}); name a source of labels: --labels, --correct-pairs, --all-correct, --ground-truth, --relations or --vertices",
            1 + unknown.count(),
            graph.edges_of(EdgeKind::Landmark).count(),
            described(first)
        );
    }
    Ok(())
}

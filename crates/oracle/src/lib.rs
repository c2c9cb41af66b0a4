//! The rejection stage that knows the truth. Optimising the remaining graph gives the paper's pseudo ground truth, which is
//! the best result that any rejection can reach.
//!
//! It is the only rejection stage that reads `truth`. Therefore it is a program of its own and not an option of another one.

pub mod cli;

use anyhow::bail;
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_stage::{Context, Examples, GraphStage, Phase, Place, counted, info};
use serde::Serialize;

/// The oracle has no options.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {}

impl GraphStage for Options {
    const NAME: &'static str = "oracle";
    const ABOUT: &'static str = "Reject the landmark edges that the truth calls incorrect";
    const PLACE: Place = Place(Phase::Judgement, 90);
    const EXAMPLES: Examples = Examples(&[(
        "Make the reference map of a graph with labels",
        "posecut oracle graph.jsonl | posecut optimize -o reference.jsonl",
    )]);

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        let (rejected, unknown) = reject_incorrect(graph);
        if unknown > 0 {
            bail!(
                "{} without \"truth\":{{\"correct\":…}} cannot be judged; use a graph from posecut-construct, or label the edges with posecut-label",
                counted(unknown, "landmark edge")
            );
        }
        info!("rejected {}", counted(rejected, "incorrect landmark edge"));
        context.statistics.note("landmark_edges", graph.edges_of(EdgeKind::Landmark).count());
        context.statistics.note("rejected", rejected);
        Ok(())
    }
}

/// Rejects the landmark edges that the truth calls incorrect. Returns their number, and the number of edges of unknown
/// correctness.
pub fn reject_incorrect(graph: &mut PoseGraph) -> (usize, usize) {
    let (mut rejected, mut unknown) = (0, 0);
    for edge in graph.edges.iter_mut().filter(|edge| edge.kind == EdgeKind::Landmark) {
        match edge.truth_correct() {
            Some(true) => {}
            Some(false) => {
                edge.reject(Options::NAME);
                rejected += 1;
            }
            None => unknown += 1,
        }
    }
    (rejected, unknown)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn incorrect_edges_are_rejected_and_unknown_ones_counted() {
        let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0}
{"kind":"node","id":1}
{"kind":"landmark","id":0,"from":0,"to":1,"truth":{"correct":true}}
{"kind":"landmark","id":1,"from":0,"to":1,"truth":{"correct":false}}
{"kind":"landmark","id":2,"from":0,"to":1}
"#;
        let mut graph = PoseGraph::read("test", text.as_bytes()).unwrap();
        assert_eq!(reject_incorrect(&mut graph), (1, 1));
        let marks: Vec<Option<&str>> = graph.edges.iter().map(|edge| edge.rejected_by.as_deref()).collect();
        assert_eq!(marks, [None, Some("oracle"), None]);
    }
}

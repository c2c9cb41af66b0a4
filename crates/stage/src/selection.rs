//! Shared code of the stages that keep some of the candidates in each pair of chains.

use posecut_graph::PoseGraph;

use crate::{Context, Doubt, counted, warn};

/// The numbers of landmark edges before and after the selection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Pairs of chains that landmark edges join.
    pub groups: usize,
    /// Landmark edges that were tested.
    pub candidates: usize,
    /// Landmark edges without a measurement.
    pub unmeasured: usize,
    /// Landmark edges that an earlier stage has rejected.
    pub rejected_before: usize,
    /// Landmark edges that were kept.
    pub kept: usize,
}

impl Selection {
    /// Marks edges of a group as rejected by `stage`, except those at the positions `kept` among `edges`. `kept` must ascend.
    pub fn keep(
        &mut self,
        graph: &mut PoseGraph,
        edges: impl ExactSizeIterator<Item = usize>,
        kept: &[usize],
        stage: &str,
    ) {
        self.candidates += edges.len();
        self.kept += kept.len();
        for (place, edge) in edges.enumerate() {
            if kept.binary_search(&place).is_err() {
                graph.edges[edge].reject(stage);
            }
        }
    }

    /// Notes the counts, warns of edges that could not be tested, and raises a doubt if no edge is kept.
    pub fn note(&self, context: &mut Context) {
        if self.unmeasured > 0 {
            warn!(
                "skipped {} without a measurement (neither tested nor rejected)",
                counted(self.unmeasured, "landmark edge")
            );
        }
        if self.candidates > 0 && self.kept == 0 {
            context.doubt(
                Doubt::NothingKept,
                format!(
                    "0 of {} kept; check the units of the information matrices, the covariances, and whether the sessions overlap",
                    counted(self.candidates, "landmark edge")
                ),
            );
        }
        let statistics = &mut context.statistics;
        statistics.note("candidates", self.candidates);
        statistics.note("groups", self.groups);
        statistics.note("unmeasured", self.unmeasured);
        statistics.note("rejected_before", self.rejected_before);
        statistics.note("rejected", self.candidates - self.kept);
    }
}

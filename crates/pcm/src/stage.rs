//! PCM as a stage: marks the landmark edges outside the maximum clique of each group.

use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{Dimension, PoseGraph};
use posecut_stage::{Context, GraphStage, counted, info, warn};
use serde::Serialize;

use crate::candidate::group;
use crate::chain::Chains;
use crate::clique::{MaximumClique, maximum_clique};
use crate::consistency::consistency_graph;
use crate::{Gate, Test};

/// The options of PCM.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// What is compared with the chi-square quantile
    #[arg(long, value_enum, default_value_t = Test::Mahalanobis)]
    pub test: Test,

    /// Probability with which a pair of correct edges passes the test
    #[arg(long, value_name = "P", default_value_t = 0.99)]
    pub probability: f64,

    /// Branch-and-bound nodes after which the largest clique so far is taken and its bound told
    #[arg(long, value_name = "NODES", default_value_t = 20_000_000)]
    pub work_limit: u64,
}

impl GraphStage for Options {
    const NAME: &'static str = "pcm";
    const ABOUT: &'static str =
        "Reject landmark edges outside the largest set that is pairwise consistent with the odometry";

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        let summary = match graph.header.dimension {
            Dimension::Two => reject::<SE2, 3>(self, graph)?,
            Dimension::Three => reject::<SE3, 6>(self, graph)?,
        };
        summary.note(context);
        Ok(())
    }
}

#[derive(Default)]
struct Summary {
    groups: usize,
    candidates: usize,
    unmeasured: usize,
    rejected_before: usize,
    pairs: usize,
    consistent_pairs: usize,
    indefinite_pairs: usize,
    clique_size: usize,
    clique_upper_bound: usize,
    work: u64,
}

impl Summary {
    fn note(&self, context: &mut Context) {
        let optimal = self.clique_size == self.clique_upper_bound;
        info!(
            "{} of {} kept, {}{}",
            self.clique_size,
            counted(self.candidates, "landmark edge"),
            counted(self.groups, "group"),
            if optimal { ", proved largest" } else { "" }
        );
        if !optimal {
            warn!(
                "the work limit ended the proof: the cliques hold {} edges, at most {} are possible; raise --work-limit",
                self.clique_size, self.clique_upper_bound
            );
        }
        if self.unmeasured > 0 {
            warn!(
                "{} landmark edges have no measurement and are neither tested nor rejected",
                self.unmeasured
            );
        }
        let statistics = &mut context.statistics;
        statistics.note("candidates", self.candidates);
        statistics.note("groups", self.groups);
        statistics.note("unmeasured", self.unmeasured);
        statistics.note("rejected_before", self.rejected_before);
        statistics.note("pairs", self.pairs);
        statistics.note("consistent_pairs", self.consistent_pairs);
        statistics.note("indefinite_pairs", self.indefinite_pairs);
        statistics.note("clique_size", self.clique_size);
        statistics.note("clique_upper_bound", self.clique_upper_bound);
        statistics.note("optimal", optimal);
        statistics.note("rejected", self.candidates - self.clique_size);
        statistics.note("branch_and_bound_nodes", self.work);
    }
}

fn reject<G: LieGroup<DOF>, const DOF: usize>(
    options: &Options,
    graph: &mut PoseGraph,
) -> anyhow::Result<Summary> {
    let gate = Gate::new(options.test, options.probability, DOF)?;
    let chains = Chains::<G, DOF>::of(graph)?;
    let grouped = group(graph, &chains)?;
    let mut summary = Summary {
        unmeasured: grouped.unmeasured,
        rejected_before: grouped.rejected_before,
        groups: grouped.groups.len(),
        ..Summary::default()
    };
    for group in &grouped.groups {
        let consistency = consistency_graph(&chains, group, gate);
        let clique: MaximumClique = maximum_clique(&consistency.graph, options.work_limit);
        let count = group.candidates.len();
        summary.candidates += count;
        summary.pairs += count * count.saturating_sub(1) / 2;
        summary.consistent_pairs += consistency.graph.edges();
        summary.indefinite_pairs += consistency.indefinite;
        summary.clique_size += clique.vertices.len();
        summary.clique_upper_bound += clique.upper_bound;
        summary.work += clique.work;
        for (vertex, candidate) in group.candidates.iter().enumerate() {
            if clique.vertices.binary_search(&vertex).is_err() {
                graph.edges[candidate.edge].reject(Options::NAME);
            }
        }
    }
    Ok(summary)
}

//! Cluster voting as a stage: marks the landmark edges that the vote does not keep.

use std::collections::HashMap;

use posecut_graph::{EdgeKind, PoseGraph, for_dimension};
use posecut_islands::{clusters, matches};
use posecut_optimize::PoseGroup;
use posecut_stage::{Context, Doubt, Examples, GraphStage, Phase, Place, counted, info, warn};
use serde::Serialize;

use crate::fit::Parts;
use crate::{Election, Quantiles, vote};

/// The options of cluster voting.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// Join landmark edges into a cluster if they are at most this many frames apart at both ends
    #[arg(long, value_name = "FRAMES", default_value_t = 5)]
    pub gap: u64,

    /// Reject edges and clusters beyond this chi-square probability
    #[arg(long, value_name = "P", default_value_t = 0.99)]
    pub probability: f64,

    /// Choose the order in which clusters are accepted
    #[arg(long, value_enum, default_value_t = Election::LargestFirst)]
    pub election: Election,
}

impl GraphStage for Options {
    const NAME: &'static str = "voting";
    const ABOUT: &'static str = "Reject clusters of landmark edges that fail chi-square tests of the optimised graph, in the manner of RRR";
    const PLACE: Place = Place(Phase::Judgement, 60);
    const DOUBTS: &'static [Doubt] = &[Doubt::NothingKept];
    const EXAMPLES: Examples = Examples(&[
        (
            "Reject clusters of edges, and optimise the poses",
            "posecut voting graph.jsonl | posecut optimize -o map.jsonl",
        ),
        (
            "Join edges up to 10 frames apart into a cluster",
            "posecut voting graph.jsonl --gap 10 -o voting.jsonl",
        ),
    ]);

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        for_dimension!(graph.header.dimension, |G, DOF| self.reject::<G, DOF>(graph, context))
    }
}

impl Options {
    fn reject<G: PoseGroup<DOF>, const DOF: usize>(
        &self,
        graph: &mut PoseGraph,
        context: &mut Context,
    ) -> anyhow::Result<()> {
        let quantiles = Quantiles::new(self.probability, DOF)?;
        let parts = Parts::<G, DOF>::of(graph)?;
        let measured: HashMap<usize, usize> =
            parts.places.iter().enumerate().map(|(landmark, &place)| (place, landmark)).collect();
        let in_use = graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.in_use()).count();
        let mut points = matches(graph)?;
        points.retain(|point| measured.contains_key(&point.edge));
        let clusters: Vec<Vec<usize>> = clusters(&points, self.gap)
            .into_iter()
            .map(|cluster| cluster.into_iter().map(|point| measured[&points[point].edge]).collect())
            .collect();
        let verdict = vote(&clusters, quantiles, self.election, &parts);
        for (landmark, &place) in parts.places.iter().enumerate() {
            if verdict.kept.binary_search(&landmark).is_err() {
                graph.edges[place].reject(Self::NAME);
            }
        }
        let (candidates, kept) = (parts.places.len(), verdict.kept.len());
        info!(
            "{kept} of {} kept, in {} of {}, {}",
            counted(candidates, "landmark edge"),
            verdict.clusters_kept,
            counted(clusters.len(), "cluster"),
            counted(verdict.fits, "optimisation")
        );
        if candidates > 0 && kept == 0 {
            context.doubt(
                Doubt::NothingKept,
                format!(
                    "0 of {} kept: no cluster passes the chi-square tests; check the units of the information and the covariances",
                    counted(candidates, "landmark edge")
                ),
            );
        }
        if in_use > candidates {
            warn!(
                "{} without a measurement: neither tested nor rejected",
                counted(in_use - candidates, "landmark edge")
            );
        }
        let statistics = &mut context.statistics;
        statistics.note("candidates", candidates);
        statistics.note("unmeasured", in_use - candidates);
        statistics.note("clusters", clusters.len());
        statistics.note("clusters_consistent", verdict.clusters_consistent);
        statistics.note("clusters_kept", verdict.clusters_kept);
        statistics.note("optimisations", verdict.fits);
        statistics.note("foreseen", verdict.foreseen);
        statistics.note("rejected", candidates - kept);
        Ok(())
    }
}

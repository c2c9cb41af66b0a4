//! RANSAC as a stage: marks the landmark edges outside the consensus set of each pair of odometry chains.

use anyhow::ensure;
use posecut_geometry::LieGroup;
use posecut_graph::{PoseGraph, for_dimension};
use posecut_pcm::candidate::group;
use posecut_pcm::chain::Chains;
use posecut_pcm::consistency::squared_distance;
use posecut_pcm::{Gate, Test};
use posecut_stage::{
    Context, Doubt, Examples, GraphStage, Phase, Place, Selection, counted, info, random, warn,
};
use serde::Serialize;

use crate::{Search, largest_consensus};

/// The options of RANSAC.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// Treat pairs of edges beyond this chi-square probability as inconsistent
    #[arg(long, value_name = "P", default_value_t = 0.99)]
    pub probability: f64,

    /// Draw this many landmark edges for each minimal set.
    ///
    /// One edge fixes the alignment of two chains; more make the vote stricter.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=8))]
    pub set_size: u32,

    /// Draw sets until at least one contains only correct edges with this probability
    #[arg(long, value_name = "P", default_value_t = 0.999)]
    pub confidence: f64,

    /// Draw at most this many sets for each pair of chains
    #[arg(long, value_name = "N", default_value_t = 10_000)]
    pub most_trials: u64,

    /// Reject all edges of a pair of chains if its consensus set has fewer edges than this
    #[arg(long, value_name = "N", default_value_t = 2)]
    pub minimum_consensus: usize,

    /// Set the seed of the random sets
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
}

impl GraphStage for Options {
    const NAME: &'static str = "ransac";
    const ABOUT: &'static str =
        "Reject landmark edges outside the largest set that agrees with a few edges drawn at random";
    const PLACE: Place = Place(Phase::Judgement, 40);
    const DOUBTS: &'static [Doubt] = &[Doubt::SearchLimit, Doubt::NothingKept];
    const EXAMPLES: Examples = Examples(&[
        (
            "Reject edges, and optimise the poses",
            "posecut ransac graph.jsonl | posecut optimize -o map.jsonl",
        ),
        ("Draw other random sets", "posecut ransac graph.jsonl --seed 2 -o ransac.jsonl"),
    ]);

    fn seed(&self) -> Option<u64> {
        Some(self.seed)
    }

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        ensure!(
            self.confidence > 0.0 && self.confidence < 1.0,
            "--confidence is {}, and must lie between 0 and 1, both excluded",
            self.confidence
        );
        let summary = for_dimension!(graph.header.dimension, |G, DOF| self.reject::<G, DOF>(graph)?);
        summary.note(context);
        Ok(())
    }
}

#[derive(Default)]
struct Summary {
    selection: Selection,
    trials: u64,
    unsure: usize,
}

impl Options {
    fn reject<G: LieGroup<DOF>, const DOF: usize>(&self, graph: &mut PoseGraph) -> anyhow::Result<Summary> {
        let gate = Gate::new(Test::Mahalanobis, self.probability, DOF)?.squared_distance;
        let search = Search {
            set_size: self.set_size as usize,
            confidence: self.confidence,
            most_trials: self.most_trials,
        };
        let chains = Chains::<G, DOF>::of(graph)?;
        if let Some(warning) = chains.warning() {
            warn!("{warning}");
        }
        let grouped = group(graph, &chains)?;
        let selection = Selection {
            groups: grouped.groups.len(),
            unmeasured: grouped.unmeasured,
            rejected_before: grouped.rejected_before,
            ..Selection::default()
        };
        let mut summary = Summary { selection, ..Summary::default() };
        for (number, group) in grouped.groups.iter().enumerate() {
            let candidates = &group.candidates;
            let (chain_a, chain_b) = (&chains.chains[group.a], &chains.chains[group.b]);
            let agree = |a: usize, b: usize| {
                let (a, b) = (&candidates[a], &candidates[b]);
                squared_distance(chain_a, chain_b, group.a == group.b, a, b)
                    .is_some_and(|distance| distance <= gate)
            };
            // Each pair of chains has its own stream, so that another pair does not change its draws.
            let mut draw = random(self.seed, &format!("ransac {number}"));
            let consensus = largest_consensus(candidates.len(), &search, &mut draw, agree);
            let kept: &[usize] =
                if consensus.members.len() < self.minimum_consensus { &[] } else { &consensus.members };
            let edges = group.candidates.iter().map(|candidate| candidate.edge);
            summary.selection.keep(graph, edges, kept, Self::NAME);
            summary.trials += consensus.trials;
            summary.unsure += usize::from(!consensus.confident);
        }
        Ok(summary)
    }
}

impl Summary {
    fn note(&self, context: &mut Context) {
        info!(
            "{} of {} kept, {}, {}",
            self.selection.kept,
            counted(self.selection.candidates, "landmark edge"),
            counted(self.selection.groups, "group"),
            counted(self.trials as usize, "trial")
        );
        if self.unsure > 0 {
            context.doubt(
                Doubt::SearchLimit,
                format!(
                    "{} reached the limit of trials before the confidence; raise --most-trials or lower --confidence",
                    counted(self.unsure, "group")
                ),
            );
        }
        self.selection.note(context);
        let statistics = &mut context.statistics;
        statistics.note("trials", self.trials);
        statistics.note("groups_not_confident", self.unsure);
    }
}

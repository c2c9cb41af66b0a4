//! The densest clique as a stage: marks the landmark edges outside it, for each pair of odometry chains.

use anyhow::ensure;
use posecut_geometry::LieGroup;
use posecut_graph::{PoseGraph, for_dimension};
use posecut_pcm::candidate::{Group, group};
use posecut_pcm::chain::Chains;
use posecut_pcm::consistency::squared_distance;
use posecut_pcm::{Gate, Test};
use posecut_stage::{Context, Examples, GraphStage, Phase, Place, Selection, counted, info, random, warn};
use serde::Serialize;

use crate::{Affinity, densest_clique};

/// How much a consistent pair counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Weight {
    /// exp(-d^2 / (2 sigma^2)), where d is the pair's Mahalanobis distance
    Gaussian,
    /// 1 for every pair, so that the densest clique is the largest
    None,
}

/// Which part of the clique is kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Select {
    /// All of them
    Clique,
    /// Only the N edges that agree best, where N is the rounded density (CLIPPER)
    Rounded,
}

/// The options of the densest clique.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct Options {
    /// Treat pairs of edges beyond this chi-square probability as inconsistent
    #[arg(long, value_name = "P", default_value_t = 0.99)]
    pub probability: f64,

    /// Choose the weight of a consistent pair
    #[arg(long, value_enum, default_value_t = Weight::Gaussian)]
    pub weight: Weight,

    /// Set the width sigma of the Gaussian weight, in standard deviations [default: 1.73 in 2D, 2.45 in 3D].
    ///
    /// The default is the square root of the degrees of freedom: the typical distance of a correct pair.
    #[arg(long, value_name = "SIGMA")]
    pub spread: Option<f64>,

    /// Choose which edges of the clique to keep
    #[arg(long, value_enum, default_value_t = Select::Clique)]
    pub select: Select,

    /// Climb from this many starts: the vertex degrees first, then random vectors
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..))]
    pub starts: u32,

    /// Set the seed of the random starts
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    pub seed: u64,
}

impl GraphStage for Options {
    const NAME: &'static str = "densest";
    const ABOUT: &'static str = "Reject landmark edges outside the pairwise consistent set that agrees best, in the manner of CLIPPER";
    const PLACE: Place = Place(Phase::Judgement, 50);
    const EXAMPLES: Examples = Examples(&[
        (
            "Reject edges, and optimise the poses",
            "posecut densest graph.jsonl | posecut optimize -o map.jsonl",
        ),
        (
            "Keep only the edges that agree best",
            "posecut densest graph.jsonl --select rounded -o densest.jsonl",
        ),
    ]);

    fn seed(&self) -> Option<u64> {
        Some(self.seed)
    }

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        if let Some(spread) = self.spread {
            ensure!(
                spread > 0.0 && spread.is_finite(),
                "--spread is {spread}, but must be a positive number of standard deviations"
            );
        }
        let summary = for_dimension!(graph.header.dimension, |G, DOF| self.reject::<G, DOF>(graph)?);
        summary.note(context);
        Ok(())
    }
}

#[derive(Default)]
struct Summary {
    selection: Selection,
    consistent_pairs: usize,
    density: f64,
    steps: usize,
}

impl Options {
    fn reject<G: LieGroup<DOF>, const DOF: usize>(&self, graph: &mut PoseGraph) -> anyhow::Result<Summary> {
        let gate = Gate::new(Test::Mahalanobis, self.probability, DOF)?;
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
            let affinity = self.affinity(&chains, group, gate);
            let mut draw = random(self.seed, &format!("densest {number}"));
            let densest = densest_clique(&affinity, self.starts as usize, &mut draw);
            let kept = match self.select {
                Select::Clique => densest.vertices.clone(),
                Select::Rounded => densest.rounded(),
            };
            let edges = group.candidates.iter().map(|candidate| candidate.edge);
            summary.selection.keep(graph, edges, &kept, Self::NAME);
            summary.consistent_pairs += affinity.pairs();
            summary.density += densest.density;
            summary.steps += densest.steps;
        }
        Ok(summary)
    }

    fn affinity<G: LieGroup<DOF>, const DOF: usize>(
        &self,
        chains: &Chains<G, DOF>,
        group: &Group<G, DOF>,
        gate: Gate,
    ) -> Affinity {
        let (chain_a, chain_b) = (&chains.chains[group.a], &chains.chains[group.b]);
        let variance = self.spread.map_or(DOF as f64, |spread| spread * spread);
        Affinity::new(group.candidates.len(), |a, b| {
            let (a, b) = (&group.candidates[a], &group.candidates[b]);
            let distance = squared_distance(chain_a, chain_b, group.a == group.b, a, b)?;
            (distance <= gate.squared_distance).then(|| match self.weight {
                Weight::Gaussian => (-0.5 * distance / variance).exp(),
                Weight::None => 1.0,
            })
        })
    }
}

impl Summary {
    fn note(&self, context: &mut Context) {
        info!(
            "{} of {} kept, {}, density {:.3}",
            self.selection.kept,
            counted(self.selection.candidates, "landmark edge"),
            counted(self.selection.groups, "group"),
            self.density
        );
        self.selection.note(context);
        let statistics = &mut context.statistics;
        statistics.note("consistent_pairs", self.consistent_pairs);
        statistics.note("density", self.density);
        statistics.note("gradient_steps", self.steps);
    }
}

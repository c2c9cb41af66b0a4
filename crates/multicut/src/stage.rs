//! The multicut as a stage: marks the landmark edges that an optimal multicut cuts, and labels the landmarks that remain.
//!
//! [`cut_graph`] makes the signed graph of a pose graph. Depends only on the costs and on [`solve`](crate::solve()); the
//! solver does not know pose graphs.

pub mod cut_graph;
pub(crate) mod landmarks;
mod moved;
pub mod solver;

use std::path::{Path, PathBuf};

use posecut_graph::PoseGraph;
use posecut_stage::{Context, Doubt, Examples, GraphStage, Phase, Place, counted, info};
use serde::Serialize;

use crate::costs::delta::Delta;
use crate::costs::support::Support;
use crate::{Solution, solve};
use cut_graph::CutOptions;
use landmarks::{label_landmarks, mark};
use moved::MovedOptions;
use solver::{SolverOptions, note};

/// The option that names the certificate's file.
const CERTIFICATE: &str = "--certificate";

/// The options of the multicut stage.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct StageOptions {
    /// Which signed graph is cut.
    #[command(flatten)]
    #[serde(flatten)]
    pub cut: CutOptions,

    /// How it is cut.
    #[command(flatten)]
    #[serde(flatten)]
    pub solver: SolverOptions,

    /// Write a certificate of the lower bound, which `posecut-partition verify` checks
    #[arg(long, value_name = "FILE", help_heading = "Proof")]
    #[serde(skip)]
    pub certificate: Option<PathBuf>,

    #[command(flatten)]
    #[serde(skip)]
    moved: MovedOptions,
}

impl StageOptions {
    /// Cuts a pose graph: marks the cut landmark edges, labels the landmarks, notes the statistics.
    fn cut(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<Solution> {
        let (costs, support) = self.cut.costs(graph)?;
        let instance = self.cut.graph_of(graph, &costs)?;
        let options = self.solver.options(self.certificate.is_some())?;
        let solution = solve(&instance, &options);
        let cut_edges = mark(graph, &costs, &solution.labels);
        let landmarks = label_landmarks(graph, &costs, &solution.labels);
        let repulsive = costs.iter().filter(|(_, cost)| *cost < 0.0).count();
        if repulsive == 0 && !costs.is_empty() {
            info!("no landmark edge has a negative cost, so nothing is cut");
        }
        let unsupported_cut = support.as_ref().map(|support| unsupported_and_cut(graph, support));
        let everything = !costs.is_empty() && cut_edges == costs.len();
        let unsupported = match (unsupported_cut, &support) {
            (Some(lone), Some(support)) => self.doubt_missing_support(lone, support, context),
            _ => false,
        };
        match (everything, unsupported) {
            (true, true) => context.also_doubt(Doubt::EverythingCut),
            (true, false) => context.doubt(
                Doubt::EverythingCut,
                format!("all landmark edges are cut ({} in use); check their costs", costs.len()),
            ),
            _ => {}
        }
        info!(
            "{cut_edges} of {} cut, {} remaining",
            counted(costs.len(), "landmark edge"),
            counted(landmarks, "landmark")
        );
        let statistics = &mut context.statistics;
        statistics.note("landmark_edges", costs.len());
        statistics.note("unsupported_edges", repulsive);
        if let Some([smallest, largest]) = support.and_then(|support| support.deltas) {
            statistics.note("delta_smallest", smallest);
            statistics.note("delta_largest", largest);
        }
        if let Some(lone) = unsupported_cut {
            statistics.note("cut_without_support", lone);
        }
        note(&solution, options.solver, context);
        let statistics = &mut context.statistics;
        statistics.note("landmarks", landmarks);
        statistics.note("cut_edges", cut_edges);
        Ok(solution)
    }

    /// Raises a doubt if most edges are cut because they have no neighbour: that follows from their spacing and is not
    /// evidence. Returns whether it does.
    fn doubt_missing_support(&self, lone: usize, support: &Support, context: &mut Context) -> bool {
        let all = support.counts.len();
        let Some([smallest, largest]) = support.deltas.filter(|_| 2 * lone > all) else { return false };
        let reach = match (smallest, largest) {
            (1, 1) => "1 frame".to_owned(),
            (one, other) if one == other => format!("{one} frames"),
            (one, other) => format!("{one} to {other} frames"),
        };
        let remedy = match self.cut.delta {
            Delta::Frames(_) => {
                "set --delta to the spacing of the candidates (--delta auto estimates it), or use posecut-verify"
            }
            Delta::Auto => "set a larger --delta, or use posecut-verify",
        };
        context.doubt(
            Doubt::NoSupportWithinDelta,
            format!(
                "{lone} of {} cut only because no other landmark edge is within {reach}, which is not evidence against them; {remedy}",
                if all == 1 { "1 landmark edge is".to_owned() } else { format!("{all} landmark edges are") }
            ),
        );
        true
    }
}

/// The number of edges that are cut and have no support edge.
fn unsupported_and_cut(graph: &PoseGraph, support: &Support) -> usize {
    support.counts.iter().filter(|&&(index, count)| count == 0 && !graph.edges[index].in_use()).count()
}

impl GraphStage for StageOptions {
    const NAME: &'static str = "multicut";
    const ABOUT: &'static str =
        "Reject the landmark edges that a minimum-cost multicut cuts, and label the landmarks";
    const PLACE: Place = Place(Phase::Judgement, 20);
    const DOUBTS: &'static [Doubt] = &[Doubt::SearchLimit, Doubt::EverythingCut, Doubt::NoSupportWithinDelta];
    const EXAMPLES: Examples = Examples(&[
        (
            "Apply the paper's method: PCM, then the multicut",
            "posecut pcm graph.jsonl | posecut multicut | posecut optimize -o map.jsonl",
        ),
        (
            "Measure the spacing of the edges, which sets what supports them",
            "posecut multicut graph.jsonl --delta auto -o multicut.jsonl",
        ),
        (
            "Prove the optimum, and check the proof",
            "posecut multicut graph.jsonl --certificate proof.json -o multicut.jsonl\nposecut partition verify proof.json graph.jsonl",
        ),
    ]);

    fn check(&self) -> anyhow::Result<()> {
        self.moved.check()?;
        self.solver.options(false).map(drop)
    }

    fn further_outputs(&self) -> Vec<(&'static str, &Path)> {
        self.certificate.iter().map(|path| (CERTIFICATE, path.as_path())).collect()
    }

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        let solution = self.cut(graph, context)?;
        if let Some(certificate) = solution.certificate {
            context.further_output(CERTIFICATE, move |mut writer| Ok(certificate.write(&mut writer)?));
        }
        Ok(())
    }
}

//! PCM as a stage: marks the landmark edges outside the maximum clique of each group.
//!
//! `summary` reports the results; `moved` handles options that belong to another program now. Depends on all of the theory,
//! and contains none of it.

mod moved;
mod summary;

use std::path::{Path, PathBuf};
use std::time::Duration;

use posecut_graph::PoseGraph;
use posecut_stage::{Context, Doubt, Examples, GraphStage, Phase, Place, warn};
use serde::Serialize;

use crate::clique::dimacs::write_dimacs;
use crate::{Options, Progress, STAGE, reject};
use moved::MovedOptions;
use summary::Summary;

/// The option for the file of the consistency graph.
const CONSISTENCY_GRAPH: &str = "--consistency-graph";

/// How often progress is updated while a group takes long.
const TICK: Duration = Duration::from_millis(200);

/// The options of the stage: those of PCM, and what a graph's history need not hold.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct StageOptions {
    /// What shapes the result.
    #[command(flatten)]
    #[serde(flatten)]
    pub pcm: Options,

    /// Write the consistency graph in DIMACS format, for other clique solvers
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    #[serde(skip)]
    pub consistency_graph: Option<PathBuf>,

    #[command(flatten)]
    #[serde(skip)]
    moved: MovedOptions,
}

impl GraphStage for StageOptions {
    const NAME: &'static str = STAGE;
    const ABOUT: &'static str =
        "Reject landmark edges outside the largest set that is pairwise consistent with the odometry";
    const PLACE: Place = Place(Phase::Judgement, 10);
    const DOUBTS: &'static [Doubt] = &[Doubt::SearchLimit, Doubt::NothingKept, Doubt::CalibrationOnPrior];
    const EXAMPLES: Examples = Examples(&[
        ("Reject edges, and optimise the poses", "posecut pcm graph.jsonl | posecut optimize -o map.jsonl"),
        (
            "Estimate the covariance scales, and reject edges that agree by chance",
            "posecut pcm graph.jsonl --scale auto --chance 3 -o pcm.jsonl",
        ),
        (
            "Halve the odometry covariances, and double those of landmark edges",
            "posecut pcm graph.jsonl --scale 0.5,2 -o pcm.jsonl",
        ),
    ]);

    fn check(&self) -> anyhow::Result<()> {
        self.moved.check()?;
        Ok(self.pcm.check()?)
    }

    fn further_outputs(&self) -> Vec<(&'static str, &Path)> {
        self.consistency_graph.iter().map(|path| (CONSISTENCY_GRAPH, path.as_path())).collect()
    }

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        let keep_graphs = self.consistency_graph.is_some();
        let mut rejection = {
            let mut bar = None;
            let bar = |progress: Progress| {
                let bar = bar.get_or_insert_with(|| {
                    let bar = context.progress(progress.all, "testing pairs, searching for cliques");
                    context.keep_drawing(&bar, TICK);
                    bar
                });
                bar.set_position(progress.done);
                if progress.done == progress.all {
                    bar.finish_and_clear();
                }
            };
            reject(&self.pcm, graph, keep_graphs, bar)?
        };
        if let Some(warning) = &rejection.warning {
            warn!("{warning}");
        }
        let graphs = std::mem::take(&mut rejection.graphs);
        if keep_graphs {
            context.further_output(CONSISTENCY_GRAPH, move |writer| Ok(write_dimacs(writer, &graphs)?));
        }
        Summary(&rejection).note(context);
        Ok(())
    }
}

//! PCM as a stage: marks the landmark edges outside the maximum clique of each group.
//!
//! The options, the work divided among groups (`budget`), what is reported (`summary`), and what other stages show or reuse:
//! [`replay`], [`selection`], [`dimacs`]. Depends on all of the theory, and holds none.

pub(crate) mod budget;
pub mod dimacs;
mod moved;
pub(crate) mod options;
pub mod replay;
pub mod selection;
pub(crate) mod summary;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use posecut_geometry::{SE2, SE3};
use posecut_graph::{Dimension, EdgeKind, PoseGraph};
use posecut_stage::{Context, Doubt, GraphStage};
use serde::Serialize;

use crate::calibration::{NoScales, ScaleEstimate, Scales, divide_information, estimate_scales};
use crate::chance::Pool;
use crate::judgement::figures::Figures;
use crate::judgement::judge;
use crate::odometry::chain::{Chains, Covariances};
use crate::pairs::candidate::{Group, Grouped, group_with};
use crate::{Options, PcmError, STAGE, Spatial, Test};
use budget::Budget;
use dimacs::{NamedGraph, write_dimacs};
use moved::MovedOptions;
use summary::{Calibration, Summary};

/// What names the file of the consistency graph.
const CONSISTENCY_GRAPH: &str = "--consistency-graph";

/// How often progress is drawn while a group takes long.
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
    const DOUBTS: &'static [Doubt] = &[Doubt::SearchLimit, Doubt::NothingKept, Doubt::CalibrationOnPrior];

    fn check(&self) -> anyhow::Result<()> {
        self.moved.check()?;
        Ok(self.pcm.check()?)
    }

    fn further_outputs(&self) -> Vec<(&'static str, &Path)> {
        self.consistency_graph.iter().map(|path| (CONSISTENCY_GRAPH, path.as_path())).collect()
    }

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        let keep_graphs = self.consistency_graph.is_some();
        let (summary, graphs) = match graph.header.dimension {
            Dimension::Two => reject::<SE2, 3>(&self.pcm, graph, keep_graphs, context)?,
            Dimension::Three => reject::<SE3, 6>(&self.pcm, graph, keep_graphs, context)?,
        };
        if keep_graphs {
            context.further_output(CONSISTENCY_GRAPH, move |writer| Ok(write_dimacs(writer, &graphs)?));
        }
        summary.note(context);
        Ok(())
    }
}

fn reject<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &mut PoseGraph,
    keep_graphs: bool,
    context: &Context,
) -> Result<(Summary, Vec<NamedGraph>), PcmError> {
    let (mut chains, mut grouped) = candidates::<G, DOF>(options, graph)?;
    let deadline = options.deadline();
    let calibration = calibrate(options, graph, &mut chains, &mut grouped.groups);
    let mut summary = Summary {
        unmeasured: grouped.unmeasured,
        rejected_before: grouped.rejected_before,
        groups: grouped.groups.len(),
        judged: Figures::default(),
        calibration,
    };
    // Without --chance every group is judged by itself, as PCM is defined.
    let pool = options.chance.map(|_| Pool::of(&chains, &grouped.groups));
    let mut graphs = Vec::new();
    let candidates = || grouped.groups.iter().map(|group| group.candidates.len());
    let mut budget = Budget::of(candidates());
    // A group takes time by the pairs of its candidates.
    let progress = context.progress(candidates().map(pairs).sum(), "testing pairs, searching for cliques");
    context.keep_drawing(&progress, TICK);
    for group in &grouped.groups {
        let count = group.candidates.len();
        let alone = options.limits(count, deadline);
        let judged = judge(options, &chains, group, pool, budget.next(count, alone), keep_graphs)?;
        budget.spend(count, alone, judged.figures.work);
        progress.inc(pairs(count));
        judged.mark(graph, group);
        if let Some((consistency, vertices)) = judged.graph {
            let id = |&vertex: &usize| graph.edges[group.candidates[vertex].edge].id;
            graphs.push(NamedGraph { edges: vertices.iter().map(id).collect(), graph: consistency });
        }
        summary.judged += judged.figures;
    }
    progress.finish_and_clear();
    Ok((summary, graphs))
}

/// How many pairs so many candidates have, and one for themselves.
fn pairs(candidates: usize) -> u64 {
    let count = candidates as u64;
    count * count.saturating_sub(1) / 2 + 1
}

/// The chains of a graph and its candidates; without covariances where no test looks at them.
pub(crate) fn candidates<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &PoseGraph,
) -> Result<(Chains<G, DOF>, Grouped<G, DOF>), PcmError> {
    let covariances =
        if options.test == Test::Threshold { Covariances::Ignored } else { Covariances::Needed };
    let chains = Chains::with(graph, covariances)?;
    let grouped = group_with(graph, &chains, covariances)?;
    Ok((chains, grouped))
}

/// Estimates scales where they are asked for, and applies those of the options to chains and candidates.
pub(crate) fn scale<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    chains: &mut Chains<G, DOF>,
    groups: &mut [Group<G, DOF>],
) -> Option<Result<ScaleEstimate, NoScales>> {
    let estimate = options.wants_estimate().then(|| estimate_scales(chains, groups));
    options.scales(estimate.and_then(Result::ok)).apply(chains, groups);
    estimate
}

/// [`scale`], and with `--calibrate` the same for the informations of the graph.
fn calibrate<G: Spatial<DOF>, const DOF: usize>(
    options: &Options,
    graph: &mut PoseGraph,
    chains: &mut Chains<G, DOF>,
    groups: &mut [Group<G, DOF>],
) -> Calibration {
    let start = Instant::now();
    let scale = scale(options, chains, groups);
    if options.calibrate {
        let estimated = scale.and_then(Result::ok).map_or(Scales::ONE, |estimate| estimate.scales);
        divide_information(graph, EdgeKind::Odometry, estimated.odometry);
        divide_information(graph, EdgeKind::Landmark, estimated.landmark);
    }
    Calibration { scale, seconds: start.elapsed().as_secs_f64() }
}

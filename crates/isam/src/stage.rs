//! Incremental optimisation as a stage.

mod lag;
mod replay;
mod session;

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context as _;
use clap::Parser;
use posecut_geometry::LieGroup;
use posecut_graph::{InputDigest, PoseGraph, RecordReader, for_dimension};
use posecut_optimize::stage::{KernelOptions, doubt_disconnected, significant, warn_of_unmeasured};
use posecut_stage::{
    CommonArguments, Context, Doubt, Examples, Identity, Outcome, Phase, Place, Source, Statistics, counted,
    info, open, run_with_doubts, warn, write_atomically,
};
use serde::Serialize;

use crate::{FinishReport, IncrementalGroup, IncrementalOptions};
pub use lag::{BeyondLag, LagOptions};
use replay::{Located, empty, for_each};
use session::{Arrival, Session};

const IDENTITY: Identity = Identity {
    name: "isam",
    version: env!("CARGO_PKG_VERSION"),
    about: "Optimise the poses of a pose graph incrementally, pose by pose, and retract edges on request",
    place: Place(Phase::Optimisation, 20),
    examples: Examples(&[
        ("Optimise the poses incrementally", "posecut isam graph.jsonl -o map.jsonl"),
        (
            "Write the estimates after every 100 poses too",
            "posecut isam graph.jsonl --every 100 --estimates estimates.jsonl \\\n    -o map.jsonl",
        ),
    ]),
};

const DOUBTS: &[Doubt] = &[Doubt::NotConverged, Doubt::PartsNotConnected];

#[derive(Parser)]
struct Command {
    /// The pose graph to read (JSON Lines, may be compressed); `-` is standard input
    #[arg(value_name = "INPUT", default_value = "-")]
    input: Source,

    #[command(flatten)]
    stage: StageOptions,

    /// Leave rejected edges out of the output instead of marking them
    #[arg(long, help_heading = "Output")]
    drop_rejected: bool,

    #[command(flatten)]
    common: CommonArguments,
}

/// The program's `main`.
pub fn main() -> ExitCode {
    run_with_doubts::<Command>(
        IDENTITY,
        DOUBTS,
        |command| &command.common,
        |command, context| {
            let mut graph = command.stage.run(&command.input, context)?;
            context.record_provenance(&mut graph, &command.stage, None)?;
            if command.drop_rejected {
                graph.drop_rejected();
            }
            context.write_graph(&graph)?;
            Ok(Outcome::Done)
        },
    )
}

/// The options of the incremental stage.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
pub struct StageOptions {
    /// Relinearise a pose when a component of its translation has changed by more than this, metres
    #[arg(long, value_name = "METRES", default_value_t = IncrementalOptions::default().relinearise_translation)]
    pub relinearise_translation: f64,

    /// Relinearise a pose when a component of its rotation has changed by more than this, radians
    #[arg(long, value_name = "RADIANS", default_value_t = IncrementalOptions::default().relinearise_rotation)]
    pub relinearise_rotation: f64,

    /// Check for relinearisation once in this many steps
    #[arg(long, value_name = "STEPS", default_value_t = IncrementalOptions::default().relinearise_every)]
    pub relinearise_every: usize,

    /// Propagate an update down the Bayes tree where a pose changed by more than this, metres or radians
    #[arg(long, value_name = "SIZE", default_value_t = IncrementalOptions::default().propagate)]
    pub propagate: f64,

    /// Relinearise poses beyond the thresholds once their linearisation errors exceed this share of the cost; 0 relinearises them at once
    #[arg(long, value_name = "SHARE", default_value_t = IncrementalOptions::default().linearisation_error)]
    pub linearisation_error: f64,

    /// Solve the linear system at most this many times per step
    #[arg(long, value_name = "N", default_value_t = IncrementalOptions::default().iterations)]
    pub solutions: usize,

    /// Skip the final relinearisation: write the estimate after the last step
    #[arg(long)]
    pub unfinished: bool,

    /// Bounded memory.
    #[command(flatten)]
    #[serde(flatten)]
    pub bounds: LagOptions,

    /// Robust kernels.
    #[command(flatten)]
    #[serde(flatten)]
    pub kernels: KernelOptions,

    /// Write the estimates of all poses to the file of `--estimates` once in this many steps, and after the last step
    #[arg(long, value_name = "STEPS", requires = "estimates", help_heading = "Intermediate estimates")]
    #[serde(skip)]
    pub every: Option<usize>,

    /// Write the intermediate estimates to FILE, JSON Lines
    #[arg(long, value_name = "FILE", requires = "every", help_heading = "Intermediate estimates")]
    #[serde(skip)]
    pub estimates: Option<PathBuf>,
}

/// A line of intermediate estimates.
#[derive(Serialize)]
struct Checkpoint<'a> {
    kind: &'static str,
    step: usize,
    node: u64,
    edges: usize,
    cost: f64,
    ids: &'a [u64],
    poses: &'a [Vec<f64>],
}

impl StageOptions {
    fn library_options(&self) -> IncrementalOptions {
        self.bounds.add_to(IncrementalOptions {
            relinearise_translation: self.relinearise_translation,
            relinearise_rotation: self.relinearise_rotation,
            relinearise_every: self.relinearise_every,
            propagate: self.propagate,
            linearisation_error: self.linearisation_error,
            iterations: self.solutions,
            ..IncrementalOptions::default()
        })
    }

    /// Follows a session and returns the graph with its last estimates.
    fn run(&self, input: &Source, context: &mut Context) -> anyhow::Result<PoseGraph> {
        anyhow::ensure!(self.every != Some(0), "--every is 0, but must be a positive number of steps");
        self.bounds.check()?;
        let Some(path) = &self.estimates else { return self.dispatch(input, None, context) };
        context.check_further_output("--estimates", path)?;
        let mut graph = None;
        write_atomically(path, |writer| {
            graph = Some(self.dispatch(input, Some(writer), context)?);
            Ok(())
        })?;
        graph.context("the session ended without a graph")
    }

    fn dispatch(
        &self,
        input: &Source,
        estimates: Option<&mut dyn Write>,
        context: &mut Context,
    ) -> anyhow::Result<PoseGraph> {
        let mut input = open(input)?;
        let source = input.name.clone();
        let reader = RecordReader::new(&source, &mut input)?;
        let graph = for_dimension!(reader.header().dimension, |G, DOF| self
            .follow::<G, DOF, _>(&source, reader, estimates, context))?;
        let sha256 = input.finish().with_context(|| format!("{source}: cannot be read to its end"))?;
        context.inputs.push(InputDigest { name: "graph".to_owned(), sha256 });
        Ok(graph)
    }

    fn follow<G: IncrementalGroup<DOF>, const DOF: usize, R: std::io::BufRead>(
        &self,
        source: &str,
        reader: RecordReader<R>,
        mut estimates: Option<&mut dyn Write>,
        context: &mut Context,
    ) -> anyhow::Result<PoseGraph> {
        let options = self.library_options();
        let mut session = Session::<G, DOF>::new(empty(&reader), options, self.kernels, self.bounds)?;
        let mut unknown = Vec::new();
        for_each(source, reader, &mut unknown, |Located { line, arrival }| {
            if matches!(arrival, Arrival::Node(_)) {
                self.end_step(&mut session, &mut estimates)?;
            }
            session.take(arrival, line).with_context(|| format!("{source}, line {line}"))
        })?;
        self.end_step(&mut session, &mut estimates)?;
        let last = session.steps.len();
        if let (Some(every), Some(writer)) = (self.every, &mut estimates)
            && !last.is_multiple_of(every)
        {
            write_checkpoint(&session, writer)?;
        }
        let finish = if self.unfinished { None } else { Some(session.solver.finish()) };
        session.refuse_unless_finite()?;
        session.write_poses();
        tell(&session, finish.as_ref(), context);
        note(&session, finish.as_ref(), context);
        let mut graph = session.graph;
        graph.unknown = unknown;
        graph.sort();
        Ok(graph)
    }

    fn end_step<G: IncrementalGroup<DOF>, const DOF: usize>(
        &self,
        session: &mut Session<G, DOF>,
        estimates: &mut Option<&mut dyn Write>,
    ) -> anyhow::Result<()> {
        let ended = session.end_step();
        match (self.every, estimates) {
            (Some(every), Some(writer)) if ended && session.steps.len().is_multiple_of(every) => {
                write_checkpoint(session, writer)
            }
            _ => Ok(()),
        }
    }
}

fn write_checkpoint<G: IncrementalGroup<DOF>, const DOF: usize>(
    session: &Session<G, DOF>,
    writer: &mut dyn Write,
) -> anyhow::Result<()> {
    let Some(node) = session.graph.nodes.last() else { return Ok(()) };
    let ids: Vec<u64> = session.graph.nodes.iter().map(|node| node.id).collect();
    let poses: Vec<Vec<f64>> = session.solver.estimates().iter().map(LieGroup::components).collect();
    let line = Checkpoint {
        kind: "estimate",
        step: session.steps.len(),
        node: node.id,
        edges: session.solver.edges().len(),
        cost: session.solver.cost(),
        ids: &ids,
        poses: &poses,
    };
    serde_json::to_writer(&mut *writer, &line)?;
    Ok(writer.write_all(b"\n")?)
}

fn tell<G: IncrementalGroup<DOF>, const DOF: usize>(
    session: &Session<G, DOF>,
    finish: Option<&FinishReport>,
    context: &mut Context,
) {
    for split in &session.splits {
        warn!(
            "after node {}: a retracted edge was the last connection of {} to the rest; this component keeps its poses, and node {} is fixed from now on",
            split.at,
            counted(split.nodes, "node"),
            split.gauge
        );
    }
    warn_of_unmeasured(session.unmeasured);
    if session.beyond_lag > 0 {
        warn!(
            "{} beyond the lag rejected, because a node was marginalised before; increase the lag to use them",
            counted(session.beyond_lag, "edge")
        );
    }
    doubt_disconnected(session.solver.parts(), session.solver.floating_parts(), context);
    let converged = finish.is_none_or(|finish| finish.converged);
    if let Some(finish) = finish.filter(|finish| !finish.converged) {
        context.doubt(
            Doubt::NotConverged,
            format!(
                "the final relinearisation did not converge after {}: the poses are not a minimum of the cost; optimise the result \
                 with posecut-optimize",
                counted(finish.iterations, "iteration")
            ),
        );
    }
    let marginalised = session.solver.poses() - session.solver.live_poses().len();
    let past = if marginalised > 0 {
        format!(", {} marginalised", counted(marginalised, "pose"))
    } else {
        String::new()
    };
    info!(
        "cost {} after {}, {}, {} retracted, {} re-admitted{past}{}",
        significant(session.solver.cost()),
        counted(session.steps.len(), "step"),
        counted(session.solver.parts(), "component"),
        counted(session.retracted, "edge"),
        session.readmitted,
        if converged { "" } else { ", did not converge" }
    );
}

fn note<G: IncrementalGroup<DOF>, const DOF: usize>(
    session: &Session<G, DOF>,
    finish: Option<&FinishReport>,
    context: &mut Context,
) {
    let statistics = &mut context.statistics;
    statistics.note("edges", session.solver.edges().len());
    statistics.note("unmeasured", session.unmeasured);
    statistics.note("retracted", session.retracted);
    statistics.note("readmitted", session.readmitted);
    statistics.note("components", session.solver.parts());
    statistics.note("splits", &session.splits);
    statistics.note("restarts", session.restarts);
    note_lag(session, statistics);
    statistics.note("cost_before_finish", finish.map(|finish| finish.cost_before));
    statistics.note("finish_iterations", finish.map(|finish| finish.iterations));
    statistics.note("converged", finish.map(|finish| finish.converged));
    statistics.note("cost", session.solver.cost());
    let mut seconds: Vec<f64> = session.steps.iter().map(|step| step.seconds).collect();
    seconds.sort_by(f64::total_cmp);
    let quantile =
        |share: f64| seconds.get((seconds.len().saturating_sub(1) as f64 * share).round() as usize);
    statistics.note("step_seconds_total", seconds.iter().sum::<f64>());
    for (name, share) in [
        ("step_seconds_median", 0.5),
        ("step_seconds_p95", 0.95),
        ("step_seconds_p99", 0.99),
        ("step_seconds_max", 1.0),
    ] {
        statistics.note(name, quantile(share));
    }
    statistics.note("steps", &session.steps);
}

/// What a lag has done. Nodes that are not among the live ones are final.
fn note_lag<G: IncrementalGroup<DOF>, const DOF: usize>(
    session: &Session<G, DOF>,
    statistics: &mut Statistics,
) {
    let live = session.solver.live_poses();
    let marginalised = session.solver.poses() - live.len();
    statistics.note("marginalised", marginalised);
    statistics.note("absorbed_edges", session.solver.absorbed_edges());
    statistics.note("beyond_lag", session.beyond_lag);
    statistics.note("live_nodes_max", session.most_live);
    statistics.note("prior_nodes", session.solver.prior_sizes());
    if marginalised > 0 {
        let ids: Vec<u64> = live.iter().map(|&node| session.graph.nodes[node].id).collect();
        statistics.note("live_nodes", ids);
    }
}

//! Incremental optimisation as a stage.

use std::io::Write;
use std::path::PathBuf;

use anyhow::Context as _;
use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{Dimension, InputDigest, PoseGraph, RecordReader};
use posecut_stage::{Context, Doubt, Source, counted, info, open, warn, write_atomically};
use serde::Serialize;

use super::replay::{Located, empty, for_each};
use super::session::{Arrival, Kernels, Session};
use super::{FinishReport, IncrementalOptions};
use crate::PoseGroup;
use crate::stage::figures::significant;
use crate::stage::{StageOptions, doubt_disconnected, warn_of_unmeasured};

/// Options of the incremental mode.
#[derive(Clone, Debug, PartialEq, clap::Args)]
pub struct IncrementalStageOptions {
    /// Relinearise a pose when a component of its translation has moved by more than this since, metres
    #[arg(long, value_name = "METRES", default_value_t = IncrementalOptions::default().relinearise_translation, help_heading = "Incremental (--solver isam2)")]
    pub relinearise_translation: f64,

    /// The same for components of its rotation, radians
    #[arg(long, value_name = "RADIANS", default_value_t = IncrementalOptions::default().relinearise_rotation, help_heading = "Incremental (--solver isam2)")]
    pub relinearise_rotation: f64,

    /// Consider relinearisation in every so many steps
    #[arg(long, value_name = "STEPS", default_value_t = IncrementalOptions::default().relinearise_every, help_heading = "Incremental (--solver isam2)")]
    pub relinearise_every: usize,

    /// Solve on below a pose that has changed by more than this, metres and radians
    #[arg(long, value_name = "SIZE", default_value_t = IncrementalOptions::default().propagate, help_heading = "Incremental (--solver isam2)")]
    pub propagate: f64,

    /// Relinearise once linearisation errors amount to this share of the cost; 0 does in any case
    #[arg(long, value_name = "SHARE", default_value_t = IncrementalOptions::default().linearisation_error, help_heading = "Incremental (--solver isam2)")]
    pub linearisation_error: f64,

    /// Most linear solutions in a step
    #[arg(long, value_name = "N", default_value_t = IncrementalOptions::default().iterations, help_heading = "Incremental (--solver isam2)")]
    pub solutions: usize,

    /// Leave the estimate as it stands after the last step, without relinearising everything until it stands still
    #[arg(long, help_heading = "Incremental (--solver isam2)")]
    pub unfinished: bool,

    /// Write the estimates of all poses after every so many steps, and after the last, to the file of --estimates
    #[arg(long, value_name = "STEPS", requires = "estimates", help_heading = "Incremental (--solver isam2)")]
    pub every: Option<usize>,

    /// Where the estimates on the way go, JSON Lines
    #[arg(long, value_name = "FILE", requires = "every", help_heading = "Incremental (--solver isam2)")]
    pub estimates: Option<PathBuf>,
}

/// What shapes the result, for the provenance.
#[derive(Serialize)]
struct Arguments<'a> {
    solver: &'static str,
    relinearise_translation: f64,
    relinearise_rotation: f64,
    relinearise_every: usize,
    propagate: f64,
    linearisation_error: f64,
    solutions: usize,
    unfinished: bool,
    #[serde(flatten)]
    robust: &'a crate::stage::RobustOptions,
}

/// A line of estimates on the way.
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

impl IncrementalStageOptions {
    fn library_options(&self) -> IncrementalOptions {
        IncrementalOptions {
            relinearise_translation: self.relinearise_translation,
            relinearise_rotation: self.relinearise_rotation,
            relinearise_every: self.relinearise_every,
            propagate: self.propagate,
            linearisation_error: self.linearisation_error,
            iterations: self.solutions,
        }
    }

    /// Follows a session and returns the graph with its last estimates.
    pub(crate) fn run(
        &self,
        input: &Source,
        batch: &StageOptions,
        context: &mut Context,
    ) -> anyhow::Result<PoseGraph> {
        anyhow::ensure!(self.every != Some(0), "--every is 0, and must be a positive number of steps");
        let Some(path) = &self.estimates else { return self.dispatch(input, batch, None, context) };
        context.check_further_output("--estimates", path)?;
        let mut graph = None;
        write_atomically(path, |writer| {
            graph = Some(self.dispatch(input, batch, Some(writer), context)?);
            Ok(())
        })?;
        graph.context("the session ended without a graph")
    }

    fn dispatch(
        &self,
        input: &Source,
        batch: &StageOptions,
        estimates: Option<&mut dyn Write>,
        context: &mut Context,
    ) -> anyhow::Result<PoseGraph> {
        let mut input = open(input)?;
        let source = input.name.clone();
        let reader = RecordReader::new(&source, &mut input)?;
        let mut graph = match reader.header().dimension {
            Dimension::Two => self.follow::<SE2, 3, _>(&source, reader, batch, estimates, context),
            Dimension::Three => self.follow::<SE3, 6, _>(&source, reader, batch, estimates, context),
        }?;
        let sha256 = input.finish().with_context(|| format!("{source}: cannot be read to its end"))?;
        context.inputs.push(InputDigest { name: "graph".to_owned(), sha256 });
        let arguments = Arguments {
            solver: "isam2",
            relinearise_translation: self.relinearise_translation,
            relinearise_rotation: self.relinearise_rotation,
            relinearise_every: self.relinearise_every,
            propagate: self.propagate,
            linearisation_error: self.linearisation_error,
            solutions: self.solutions,
            unfinished: self.unfinished,
            robust: &batch.robust,
        };
        context.record_provenance(&mut graph, &arguments, None)?;
        Ok(graph)
    }

    fn follow<G: PoseGroup<DOF>, const DOF: usize, R: std::io::BufRead>(
        &self,
        source: &str,
        reader: RecordReader<R>,
        batch: &StageOptions,
        mut estimates: Option<&mut dyn Write>,
        context: &mut Context,
    ) -> anyhow::Result<PoseGraph> {
        let kernels =
            Kernels { odometry: batch.robust.kernel_odometry, landmark: batch.robust.kernel_landmark };
        let mut session = Session::<G, DOF>::new(empty(&reader), self.library_options(), kernels)?;
        let mut unknown = Vec::new();
        for_each(source, reader, &mut unknown, |Located { line, arrival }| {
            if matches!(arrival, Arrival::Node(_)) {
                self.end_step(&mut session, &mut estimates)?;
            }
            session.take(arrival).with_context(|| format!("{source}, line {line}"))
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

    fn end_step<G: PoseGroup<DOF>, const DOF: usize>(
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

fn write_checkpoint<G: PoseGroup<DOF>, const DOF: usize>(
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

fn tell<G: PoseGroup<DOF>, const DOF: usize>(
    session: &Session<G, DOF>,
    finish: Option<&FinishReport>,
    context: &mut Context,
) {
    for split in &session.splits {
        warn!(
            "after node {}: an edge was taken back that had joined {} to the rest; the part stays where it was, and node {} is held fixed",
            split.at,
            counted(split.nodes, "node"),
            split.gauge
        );
    }
    warn_of_unmeasured(session.unmeasured);
    doubt_disconnected(session.solver.parts(), session.solver.floating_parts(), context);
    let converged = finish.is_none_or(|finish| finish.converged);
    if let Some(finish) = finish.filter(|finish| !finish.converged) {
        context.doubt(
            Doubt::NotConverged,
            format!(
                "the final relinearisation did not converge after {}: the poses are not a minimum of the cost; optimise the result \
                 with --solver batch",
                counted(finish.iterations, "iteration")
            ),
        );
    }
    info!(
        "cost {} after {}, {}, {} retracted, {} re-admitted{}",
        significant(session.solver.cost()),
        counted(session.steps.len(), "step"),
        counted(session.solver.parts(), "component"),
        counted(session.retracted, "edge"),
        session.readmitted,
        if converged { "" } else { ", did not converge" }
    );
}

fn note<G: PoseGroup<DOF>, const DOF: usize>(
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

//! The run: read, judge, optimise, examine, write.

use std::time::Duration;

use anyhow::{bail, ensure};
use posecut_convert::FileFormat;
use posecut_convert::input::{Reading, read};
use posecut_doctor::{Finding, examine_with};
use posecut_graph::PoseGraph;
use posecut_optimize::stage::StageOptions;
use posecut_stage::registry::Registry;
use posecut_stage::{Context, Doubt, GraphStage as _, Inside, Statistics, info};
use posecut_verify::{Options, Verification};

use crate::alternatives::alternatives;
use crate::command::Command;
use crate::files::write_files;
use crate::method::{Method, Stage};
use crate::movement::Movement;
use crate::report::report;
use crate::summary::{Input, line};

/// How often the progress bar is redrawn while a step runs.
const REDRAW: Duration = Duration::from_millis(200);

/// What judging, optimising and examining a graph found.
pub(crate) struct Cleaned {
    /// The graph as it was read.
    pub(crate) before: PoseGraph,
    /// The findings and the statistics of verification, if it is the method.
    pub(crate) verification: Option<(Verification, Statistics)>,
    pub(crate) optimization: Statistics,
    pub(crate) movement: Option<Movement>,
    /// What is wrong with the graph as it was read.
    pub(crate) findings: Vec<Finding>,
    /// The result under other hypotheses, for the page.
    pub(crate) alternatives: Vec<(String, PoseGraph)>,
    /// Doubts of the stages within this program, with their sentences.
    pub(crate) doubts: Vec<(Doubt, String)>,
}

impl Cleaned {
    /// What verification found.
    pub(crate) fn verified(&self) -> Option<&Verification> {
        self.verification.as_ref().map(|(found, _)| found)
    }
}

/// Does everything that the command line asks for.
pub(crate) fn clean(command: &Command, context: &mut Context) -> anyhow::Result<()> {
    let method = Method::parse(&command.judgement.method, &Registry::of_this_machine())?;
    ensure!(
        method == Method::Verify || (command.explain.is_none() && command.judgement.hypothesis == 0),
        "--explain and --hypothesis need --method verify, but it is {:?}; leave one of them out",
        command.judgement.method
    );
    for (option, path) in command.further_outputs() {
        context.check_further_output(option, path)?;
    }
    let Reading { mut graph, format, name } = read(&command.inputs, &command.reading, context)?;
    for (option, path) in command.further_outputs() {
        // Check again: only now all inputs are known.
        context.check_further_output(option, path)?;
    }
    ensure!(
        !graph.nodes.is_empty(),
        "{name}: the graph has no poses and no edges, so there is nothing to clean; check the program that wrote it"
    );
    let format = context.output_path().and_then(FileFormat::of_name).unwrap_or(format);
    if format.is_trajectory() || format == FileFormat::Evo {
        bail!(
            "{name}: the result would be a {format} file, which holds no edges; read a graph, or name an output such as clean.g2o"
        );
    }
    let input = Input::of(&name, &graph);
    let cleaned = judge_and_optimize(command, &method, &mut graph, context)?;
    report(command, &input, &cleaned, &graph, context)?;
    let written = write_files(command, &input, &cleaned, &mut graph, format, context)?;
    info!("{}", line("wrote", written));
    Ok(())
}

fn judge_and_optimize(
    command: &Command,
    method: &Method,
    graph: &mut PoseGraph,
    context: &mut Context,
) -> anyhow::Result<Cleaned> {
    let before = graph.clone();
    let progress = context.progress(3, "judging edges");
    context.keep_drawing(&progress, REDRAW);
    let mut doubts = Vec::new();
    let verification = match method {
        Method::Verify => {
            let options = verification_options(command, command.judgement.hypothesis)?;
            let inside = context.run_inside(|inner| options.judge(graph, inner))?;
            doubts.extend(inside.doubts);
            Some((inside.value, inside.statistics))
        }
        Method::Stages(stages) => {
            run_programs(stages, graph, context)?;
            None
        }
    };
    progress.set_message("optimising poses");
    progress.set_position(1);
    let Inside { statistics: optimization, doubts: of_optimization, .. } =
        context.run_inside(|inner| optimize(graph, inner))?;
    // Verification explains the same doubt better.
    let raised: Vec<Doubt> = doubts.iter().map(|(doubt, _)| *doubt).collect();
    doubts.extend(of_optimization.into_iter().filter(|(doubt, _)| !raised.contains(doubt)));
    progress.set_message("examining the input");
    progress.set_position(2);
    let found = verification.as_ref().map(|(found, _)| found);
    let findings = examine_with(&before, found);
    let alternatives = match found.filter(|_| command.page.is_some()) {
        Some(found) => alternatives(command, &before, found, context)?,
        None => Vec::new(),
    };
    progress.finish_and_clear();
    let movement = Movement::between(&before, graph);
    Ok(Cleaned { before, verification, optimization, movement, findings, alternatives, doubts })
}

/// The options of verification that the command line gives, with a hypothesis.
pub(crate) fn verification_options(command: &Command, hypothesis: usize) -> anyhow::Result<Options> {
    let options: Options = posecut_stage::options(&[])?;
    Ok(Options { undecided: command.judgement.undecided, hypothesis, ..options })
}

/// Optimises with the usual options.
pub(crate) fn optimize(graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
    posecut_stage::options::<StageOptions>(&[])?.run(graph, context)
}

/// Runs stages that are programs. They print their doubts themselves.
fn run_programs(stages: &[Stage], graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
    let known = graph.header.doubts().len();
    for stage in stages {
        *graph = stage.run(graph)?;
    }
    for raised in graph.header.doubts().iter().skip(known) {
        if let Some(doubt) = Doubt::ALL.into_iter().find(|doubt| doubt.name() == raised.doubt) {
            context.also_doubt(doubt);
        }
    }
    Ok(())
}

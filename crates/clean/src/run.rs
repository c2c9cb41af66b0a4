//! The run: read, judge, optimise, write.

use std::io::IsTerminal as _;
use std::time::Duration;

use anyhow::{Context as _, bail, ensure};
use posecut_convert::FileFormat;
use posecut_convert::input::{Reading, read};
use posecut_convert::output::{WritingOptions, write};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_inspect::edges::EdgeTable;
use posecut_optimize::stage::StageOptions;
use posecut_stage::registry::Registry;
use posecut_stage::{
    Context, Doubt, GraphStage as _, Inside, Statistics, counted, info, warn, write_atomically,
};
use posecut_verify::verdict::Verdict;
use posecut_verify::{Options, Undecided, Verification};

use crate::command::Command;
use crate::method::{Method, Stage};
use crate::movement::Movement;
use crate::summary::{self, Input, line};

/// How often the progress bar is redrawn while a step runs.
const REDRAW: Duration = Duration::from_millis(200);

/// What judging and optimising a graph found.
struct Cleaned {
    verification: Option<Verification>,
    optimization: Statistics,
    movement: Option<Movement>,
    /// Doubts of the stages within this program, with their sentences.
    doubts: Vec<(Doubt, String)>,
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
    let format = context.output_path().and_then(FileFormat::of_name).unwrap_or(format);
    if format.is_trajectory() || format == FileFormat::Evo {
        bail!(
            "{name}: the result would be a {format} file, which holds no edges; read a graph, or name an output such as clean.g2o"
        );
    }
    let input = Input::of(&name, &graph);
    let cleaned = judge_and_optimize(command, &method, &mut graph, context)?;
    report(command, &input, &cleaned, &graph, context)?;
    let written = output(command, &mut graph, format, context)?;
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
    let mut doubts = Vec::new();
    let progress = context.progress(2, "judging edges");
    context.keep_drawing(&progress, REDRAW);
    let verification = match method {
        Method::Verify => {
            let mut options: Options = posecut_stage::options(&[])?;
            options.undecided = command.judgement.undecided;
            options.hypothesis = command.judgement.hypothesis;
            let inside = context.run_inside(|inner| options.judge(graph, inner))?;
            doubts.extend(inside.doubts);
            Some(inside.value)
        }
        Method::Stages(stages) => {
            run_programs(stages, graph, context)?;
            None
        }
    };
    progress.set_message("optimising poses");
    progress.set_position(1);
    let Inside { statistics: optimization, doubts: of_optimization, .. } =
        context.run_inside(|inner| posecut_stage::options::<StageOptions>(&[])?.run(graph, inner))?;
    progress.finish_and_clear();
    // Verification explains the same doubt better.
    let raised: Vec<Doubt> = doubts.iter().map(|(doubt, _)| *doubt).collect();
    doubts.extend(of_optimization.into_iter().filter(|(doubt, _)| !raised.contains(doubt)));
    let movement = Movement::between(&before, graph);
    Ok(Cleaned { verification, optimization, movement, doubts })
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

fn report(
    command: &Command,
    input: &Input,
    cleaned: &Cleaned,
    graph: &PoseGraph,
    context: &mut Context,
) -> anyhow::Result<()> {
    let keep_undecided = command.judgement.undecided == Undecided::Keep;
    info!("{}", input.line());
    for text in summary::edges(graph, cleaned.verification.as_ref(), keep_undecided) {
        info!("{text}");
    }
    info!("{}", summary::poses(cleaned.movement, &cleaned.optimization));
    explain(command, cleaned.verification.as_ref(), graph)?;
    if let Some(warning) = cleaned.verification.as_ref().and_then(|found| found.warning.as_ref()) {
        warn!("{warning}");
    }
    for (doubt, sentence) in &cleaned.doubts {
        context.doubt(*doubt, sentence);
    }
    note(cleaned, input, graph, context);
    Ok(())
}

fn explain(command: &Command, verification: Option<&Verification>, graph: &PoseGraph) -> anyhow::Result<()> {
    let (Some(id), Some(verification)) = (command.explain, verification) else { return Ok(()) };
    for line in verification.story(graph, id)? {
        info!("{line}");
    }
    Ok(())
}

fn note(cleaned: &Cleaned, input: &Input, graph: &PoseGraph, context: &mut Context) {
    let in_use = graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.in_use()).count();
    let count = |verdict| cleaned.verification.as_ref().map(|found| found.count(verdict));
    let optimized = |name: &str| cleaned.optimization.as_map().get(name).cloned();
    let statistics = &mut context.statistics;
    statistics.note("sessions", input.sessions);
    statistics.note("nodes", input.poses);
    statistics.note("landmark_edges", input.landmark);
    statistics.note("in_use", in_use);
    statistics.note("accepted", count(Verdict::Accepted));
    statistics.note("rejected", count(Verdict::Rejected).unwrap_or(input.landmark - in_use));
    statistics.note("undecided", count(Verdict::Undecided));
    statistics.note("rivals", cleaned.verification.as_ref().map(|found| &found.rivals));
    statistics.note("calibration", cleaned.verification.as_ref().map(|found| &found.calibration));
    statistics.note("moved_median", cleaned.movement.map(|moved| moved.median));
    statistics.note("moved_most", cleaned.movement.map(|moved| moved.most));
    statistics.note("cost", optimized("cost"));
    statistics.note("converged", optimized("converged"));
}

/// Writes the files, the graph last, and says which.
fn output(
    command: &Command,
    graph: &mut PoseGraph,
    format: FileFormat,
    context: &mut Context,
) -> anyhow::Result<String> {
    context.statistics.note("format", format.to_string());
    let mut written = Vec::new();
    if let Some(path) = &command.edges {
        let table = EdgeTable::of(graph)?;
        write_atomically(path, |writer| Ok(table.write_csv(writer)?))?;
        written.push(path.display().to_string());
    }
    let rejected = graph.edges_of(EdgeKind::Landmark).filter(|edge| !edge.in_use()).count();
    context.record_provenance(graph, &command.judgement, None)?;
    let marked = format == FileFormat::Jsonl && !command.drop_rejected;
    if !marked {
        graph.drop_rejected();
    }
    let bytes = write(graph, format, &WritingOptions::default(), context)?;
    let rejected = counted(rejected, "rejected landmark edge");
    let how = if marked { "with a mark on" } else { "without" };
    match context.output_path() {
        None if std::io::stdout().is_terminal() => {
            written.push("no graph: name a file with -o, or redirect standard output".to_owned());
        }
        path => {
            let name = path.map_or_else(|| "standard output".to_owned(), |path| path.display().to_string());
            written.push(format!("{name} ({format}, {how} {rejected})"));
            context
                .write_graph_bytes(&bytes)
                .with_context(|| format!("{name}: the graph cannot be written"))?;
        }
    }
    Ok(written.join(", "))
}

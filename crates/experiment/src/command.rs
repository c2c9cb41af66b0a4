//! The command line.

use std::path::{Path, PathBuf};

use crate::check::{accept, check};
use crate::{Expected, Plan, Programs, RunOptions, Selection, collect, junit, make_rules, run};
use anyhow::{Context as _, bail};
use clap::{Parser, Subcommand, ValueEnum};
use posecut_stage::{CommonArguments, Context, Outcome, counted, info, write_atomically};

#[derive(Parser)]
pub(crate) struct Command {
    #[command(subcommand)]
    task: Task,

    #[command(flatten)]
    pub(crate) common: CommonArguments,
}

#[derive(Subcommand)]
enum Task {
    /// Expand experiments into tasks: command line, inputs, outputs and digest of each stage call
    Plan {
        #[command(flatten)]
        selection: Selection,

        /// Choose the format of the plan
        #[arg(long, value_enum, default_value_t = Format::Tasks)]
        format: Format,
    },
    /// Run all unfinished tasks, --threads of them at once
    Run {
        #[command(flatten)]
        selection: Selection,

        /// Run only the tasks that several runs share: simulated sessions and session graphs
        #[arg(long, conflicts_with = "shard")]
        shared: bool,

        /// Run only share K of N of the runs, after a run with --shared
        #[arg(long, value_name = "K/N", value_parser = shard)]
        shard: Option<(usize, usize)>,

        /// Run failed runs again, even if their program, options and input have not changed
        #[arg(long)]
        retry: bool,
    },
    /// Collect all results, failed runs included, in one JSON Lines file
    Collect {
        #[command(flatten)]
        selection: Selection,

        /// Write the CPU seconds of each run's method to this JSON Lines file
        #[arg(long, value_name = "FILE")]
        times: Option<PathBuf>,
    },
    /// Compare results with expectations; exit status 1 if they differ
    Check {
        #[command(flatten)]
        selection: Selection,

        /// Use the expectations in this file
        #[arg(long, value_name = "FILE", default_value = "pipelines/expected.toml")]
        expected: PathBuf,

        /// Also write the comparison to this file, as JUnit XML
        #[arg(long, value_name = "FILE")]
        junit: Option<PathBuf>,
    },
    /// Record results as the new expectations, and show the changes
    Accept {
        #[command(flatten)]
        selection: Selection,

        /// Use the expectations in this file
        #[arg(long, value_name = "FILE", default_value = "pipelines/expected.toml")]
        expected: PathBuf,
    },
    /// List the stage programs and their versions; exit status 1 if one is missing
    Stages {
        /// Read the list of stage programs from this file
        #[arg(long, value_name = "FILE", default_value = "pipelines/stages.toml")]
        stages: PathBuf,

        /// Look for stage programs named without a path in this folder [default: the folder of this program]
        #[arg(long, value_name = "DIRECTORY")]
        programs: Option<PathBuf>,
    },
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    /// JSON Lines, one task per line, for any engine
    Tasks,
    /// Rules for make -f
    Make,
    /// The names of the result files
    Results,
}

fn shard(text: &str) -> Result<(usize, usize), String> {
    let wrong = || format!("\"{text}\" is not a share; write K/N, such as 3/10 for the third of ten");
    let (shard, of) = text.split_once('/').ok_or_else(wrong)?;
    let (shard, of): (usize, usize) = (shard.parse().map_err(|_| wrong())?, of.parse().map_err(|_| wrong())?);
    if (1..=of).contains(&shard) { Ok((shard, of)) } else { Err(wrong()) }
}

pub(crate) fn execute(command: &Command, context: &mut Context) -> anyhow::Result<Outcome> {
    match &command.task {
        Task::Plan { selection, format } => write_plan(&selection.plan()?, *format, context),
        Task::Run { selection, shared, shard, retry } => {
            let options =
                RunOptions { threads: context.threads(), shared: *shared, shard: *shard, retry: *retry };
            execute_run(selection, &options, context)
        }
        Task::Collect { selection, times } => execute_collect(selection, times.as_deref(), context),
        Task::Check { selection, expected, junit } => {
            execute_check(selection, expected, junit.as_deref(), context)
        }
        Task::Accept { selection, expected } => {
            let plan = selection.plan()?;
            note_read(context, &plan);
            context.note_read(expected);
            let before = Expected::read(expected)?;
            let (after, changes) = accept(&before, &plan, &selection.results)?;
            let text = after.write()?;
            // Show the changes first: if that fails, nothing is recorded.
            context.write_bytes(changes.as_bytes())?;
            write_atomically(expected, |writer| Ok(writer.write_all(text.as_bytes())?))?;
            Ok(Outcome::Done)
        }
        Task::Stages { stages, programs } => list_stages(stages, programs.as_ref(), context),
    }
}

fn write_plan(plan: &Plan, format: Format, context: &mut Context) -> anyhow::Result<Outcome> {
    let bytes = match format {
        Format::Tasks => {
            let mut bytes = Vec::new();
            plan.write(&mut bytes)?;
            bytes
        }
        Format::Make => make_rules(plan).into_bytes(),
        Format::Results => plan.results().flat_map(|path| [path, "\n"]).collect::<String>().into_bytes(),
    };
    context.statistics.note("tasks", plan.tasks.len());
    context.statistics.note("results", plan.results().count());
    context.write_bytes(&bytes)?;
    Ok(Outcome::Done)
}

fn execute_collect(
    selection: &Selection,
    times: Option<&Path>,
    context: &mut Context,
) -> anyhow::Result<Outcome> {
    let plan = selection.plan()?;
    note_read(context, &plan);
    if let Some(file) = times {
        context.check_further_output("--times", file)?;
    }
    context.check_output()?;
    let collected = collect(&plan)?;
    info!(
        "{}, {}, {} missing",
        counted(collected.found, "result"),
        counted(collected.failed, "failed run"),
        collected.missing
    );
    context.statistics.note("results", collected.found);
    context.statistics.note("failed", collected.failed);
    context.statistics.note("missing", collected.missing);
    if let Some(file) = times {
        write_atomically(file, |writer| Ok(writer.write_all(&collected.times)?))?;
    }
    context.write_bytes(&collected.results)?;
    Ok(if collected.missing == 0 { Outcome::Done } else { Outcome::CheckFailed })
}

fn execute_check(
    selection: &Selection,
    expected: &Path,
    file: Option<&Path>,
    context: &mut Context,
) -> anyhow::Result<Outcome> {
    let plan = selection.plan()?;
    note_read(context, &plan);
    context.note_read(expected);
    if let Some(file) = file {
        context.check_further_output("--junit", file)?;
    }
    context.check_output()?;
    let report = check(&Expected::read(expected)?, &plan, &selection.results);
    if let Some(file) = file {
        write_atomically(file, |writer| Ok(writer.write_all(junit(&report).as_bytes())?))?;
    }
    if report.rows.is_empty() {
        bail!("{}: has no expectations for these experiments; add them under [[cover]]", expected.display());
    }
    context.statistics.note("rows", report.rows.len());
    context.statistics.note("not_checked", report.not_checked);
    context.statistics.note("holds", report.holds());
    context.write_bytes(report.text(&plan)?.as_bytes())?;
    Ok(if report.holds() { Outcome::Done } else { Outcome::CheckFailed })
}

/// Notes all files that a plan reads and writes, so that no output may replace them.
fn note_read(context: &mut Context, plan: &Plan) {
    for task in &plan.tasks {
        context.note_read(&task.id);
    }
}

fn execute_run(
    selection: &Selection,
    options: &RunOptions,
    context: &mut Context,
) -> anyhow::Result<Outcome> {
    let plan = selection.plan()?;
    let progress = context.progress(0, "stages");
    let summary = run(&plan, options, &progress)?;
    progress.finish_and_clear();
    info!("{} run, {} finished before", counted(summary.run, "task"), summary.finished_before);
    context.statistics.note("run", summary.run);
    context.statistics.note("finished_before", summary.finished_before);
    if summary.failed_runs > 0 {
        info!("{} recorded", counted(summary.failed_runs, "failed run"));
    }
    context.statistics.note("failed_runs", summary.failed_runs);
    context.statistics.note("without_input", summary.without_input);
    context.statistics.note("failed", &summary.failed);
    context.statistics.note("not_run", summary.not_run);
    context.statistics.note("stages", &summary.stages);
    if !summary.failed.is_empty() {
        bail!(
            "{} failed twice ({} not run); fix the cause and run again: finished tasks are kept\n  {}",
            counted(summary.failed.len(), "task"),
            counted(summary.not_run, "dependent task"),
            summary.failed.join("\n  ")
        );
    }
    Ok(Outcome::Done)
}

fn list_stages(stages: &Path, programs: Option<&PathBuf>, context: &mut Context) -> anyhow::Result<Outcome> {
    let beside = std::env::current_exe().ok().and_then(|path| Some(path.parent()?.to_owned()));
    let folder =
        programs.cloned().or(beside).context("the folder of programs is unknown; name it with --programs")?;
    let mut text = String::new();
    let mut outcome = Outcome::Done;
    for (stage, program, version) in Programs::read(stages, Some(&folder))?.versions() {
        let said = version.unwrap_or_else(|error| {
            outcome = Outcome::CheckFailed;
            format!("missing: {error:#}")
        });
        text.push_str(&format!("{stage}\t{program}\t{said}\n"));
    }
    context.write_bytes(text.as_bytes())?;
    Ok(outcome)
}

//! The command line of `posecut-report`: writes tables, figures and one HTML page of experiments.

use std::process::ExitCode;

use crate::task::{figures, html, regimes, table, trust};
use clap::{Parser, Subcommand};
use posecut_stage::{CommonArguments, Examples, Identity, Outcome, Phase, Place, run};

#[derive(Parser)]
struct Command {
    #[command(subcommand)]
    task: Task,

    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Subcommand)]
enum Task {
    /// Write a table of methods by sessions: mean and spread over seeds, with published figures
    Table(table::Table),
    /// Write one self-contained HTML page: tables, maps, matrices, errors and regimes
    Html(html::Html),
    /// Draw the trajectories of sessions, one panel per graph (SVG, PDF or PNG, by the name given to -o)
    Trajectories(figures::Trajectories),
    /// Draw optimised graphs over their reference, with false edges marked (SVG, PDF or PNG, by the name given to -o)
    Graphs(figures::Graphs),
    /// Draw which candidates of PCM are consistent with each other (SVG, PDF or PNG, by the name given to -o)
    Consistency(figures::Consistency),
    /// Draw the landmarks that the multicut found (SVG, PDF or PNG, by the name given to -o)
    Components(figures::Components),
    /// Draw the error of each pose along a session, one line per method (SVG, PDF or PNG, by the name given to -o)
    Error(figures::Error),
    /// Show where the graph cut helps, is neutral or hurts: heat maps and curves (SVG, PDF or PNG), or tables
    Regimes(regimes::Regimes),
    /// Compare all methods on all families of graphs: regret, false edges, recall, and which method to use
    Trust(trust::Trust),
}

const EXAMPLES: Examples = Examples(&[
    ("Write a table of results", "posecut report table results/ -o table.md"),
    ("Write a page of results that needs no network", "posecut report html results/ -o report.html"),
    (
        "Draw the trajectories of two sessions",
        "posecut report trajectories 2012-01-22.jsonl 2012-03-31.jsonl -o map.svg",
    ),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "report",
        version: env!("CARGO_PKG_VERSION"),
        about: "Write tables, figures and an HTML page of experiments",
        place: Place(Phase::Results, 20),
        examples: EXAMPLES,
    };
    run::<Command>(
        identity,
        |command| &command.common,
        |command, context| {
            let common = &command.common;
            let bytes = match &command.task {
                Task::Table(task) => task.write()?,
                Task::Html(task) => task.write(context)?,
                Task::Trajectories(task) => task.write(common, context)?,
                Task::Graphs(task) => task.write(common, context)?,
                Task::Consistency(task) => task.write(common, context)?,
                Task::Components(task) => task.write(common, context)?,
                Task::Error(task) => task.write(common, context)?,
                Task::Regimes(task) => task.write(common)?,
                Task::Trust(task) => task.write(context)?,
            };
            context.write_bytes(&bytes)?;
            Ok(Outcome::Done)
        },
    )
}

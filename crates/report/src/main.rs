//! `posecut-report`: tables, figures and one page of experiments.

mod task;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use posecut_stage::{CommonArguments, Identity, Outcome, run};
use task::{figures, html, table};

#[derive(Parser)]
struct Command {
    #[command(subcommand)]
    task: Task,

    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Subcommand)]
enum Task {
    /// Methods against sessions, mean and spread over seeds, beside published figures
    Table(table::Table),
    /// One self-contained HTML page: tables, maps, matrices, errors and regimes
    Html(html::Html),
    /// Where the sessions went, one panel a graph (SVG, PDF or PNG by the name given to -o)
    Trajectories(figures::Trajectories),
    /// Optimised graphs over their reference, with false edges visible (SVG, PDF or PNG by the name given to -o)
    Graphs(figures::Graphs),
}

fn main() -> ExitCode {
    let identity = Identity {
        name: "report",
        version: env!("CARGO_PKG_VERSION"),
        about: "Write tables, figures and one page of experiments",
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
            };
            context.write_bytes(&bytes)?;
            Ok(Outcome::Done)
        },
    )
}

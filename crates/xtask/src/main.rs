//! `cargo xtask`: the tasks of posecut's maintainers.

#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "this program talks to the person at the terminal"
)]

mod edges_table;
mod licences;
mod machine;
mod markdown;
mod measure;
mod numbers;
mod plant_faults;
mod process;
mod regimes;
mod remake;
mod reproduction;
mod splicing;
mod test_data;
mod time_experiment;
mod twister;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// Run the maintenance tasks of posecut: generated documents, licences, test data, measurements and their tables
#[derive(Parser)]
#[command(name = "xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Subcommand)]
enum Task {
    Splice(splicing::Splice),
    Documentation(remake::Documentation),
    Licences(licences::Licences),
    TestData(test_data::TestData),
    EdgesTable(edges_table::EdgesTable),
    Reproduction(reproduction::Reproduction),
    Regimes(regimes::Regimes),
    TimeExperiment(time_experiment::TimeExperiment),
    PlantFaults(plant_faults::PlantFaults),
    Measure(measure::Measure),
}

/// The result of a check. The exit status is 1 if the check fails, and 2 for errors.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Holds,
    Fails,
}

fn main() -> ExitCode {
    let verdict = match Arguments::parse().task {
        Task::Splice(task) => task.run(),
        Task::Documentation(task) => task.run(),
        Task::Licences(task) => task.run(),
        Task::TestData(task) => task.run(),
        Task::EdgesTable(task) => task.run(),
        Task::Reproduction(task) => task.run(),
        Task::Regimes(task) => task.run(),
        Task::TimeExperiment(task) => task.run(),
        Task::PlantFaults(task) => task.run(),
        Task::Measure(task) => task.run(),
    };
    match verdict {
        Ok(Verdict::Holds) => ExitCode::SUCCESS,
        Ok(Verdict::Fails) => ExitCode::from(1),
        Err(error) => {
            eprintln!("xtask: error: {error:#}");
            ExitCode::from(2)
        }
    }
}

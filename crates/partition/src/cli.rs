//! The command line of `posecut-partition`: minimum-cost multicuts of plain signed graphs, and checks of certificates.

mod solve;
mod verify;

use std::process::ExitCode;

use clap::{Parser, Subcommand};
use posecut_stage::{CommonArguments, Doubt, Examples, Identity, Phase, Place, run_with_doubts};

#[derive(Parser)]
struct Command {
    #[command(subcommand)]
    task: Task,

    #[command(flatten)]
    common: CommonArguments,
}

#[derive(Subcommand)]
enum Task {
    /// Find a minimum-cost multicut of a signed graph, and write one label per line, in the order of the nodes
    Solve(solve::Arguments),
    /// Check what a certificate proves about a signed graph or a pose graph; exit status 1 if it does not hold
    Verify(verify::Arguments),
}

const EXAMPLES: Examples = Examples(&[
    (
        "Partition a signed graph, and prove the optimum",
        "posecut partition solve signed.txt --certificate proof.json -o labels.txt",
    ),
    ("Check the proof", "posecut partition verify proof.json signed.txt"),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "partition",
        version: env!("CARGO_PKG_VERSION"),
        about: "Partition a signed graph by a minimum-cost multicut, or check a certificate of a multicut",
        place: Place(Phase::Judgement, 25),
        examples: EXAMPLES,
    };
    run_with_doubts::<Command>(
        identity,
        &[Doubt::SearchLimit],
        |command| &command.common,
        |command, context| match &command.task {
            Task::Solve(arguments) => solve::run(arguments, context),
            Task::Verify(arguments) => verify::run(arguments, context),
        },
    )
}

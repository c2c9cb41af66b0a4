//! The command line of `posecut-simulate-log`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use posecut_carmen::write_trajectory;
use posecut_stage::{
    CommonArguments, Context, Examples, Identity, Outcome, Phase, Place, counted, info, run, write_atomically,
};

use crate::relations::{relations, write_relations};
use crate::{Options, simulate};

#[derive(Parser)]
struct Command {
    #[command(flatten)]
    options: Options,

    /// Write the true pose at each scan to this file, in the format of the TUM benchmark
    #[arg(long, value_name = "FILE")]
    truth: Option<PathBuf>,

    /// Write true motions between pairs of times to this file, for posecut-evaluate
    #[arg(long, value_name = "FILE")]
    relations: Option<PathBuf>,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    (
        "Simulate a log with relations",
        "posecut simulate-log --relations robot.relations -o robot.log\nposecut ingest robot.log --scan-matching -o robot.jsonl",
    ),
    ("Drive 1 km through a large building", "posecut simulate-log --blocks 5 --length 1000 -o robot.log.gz"),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "simulate-log",
        version: env!("CARGO_PKG_VERSION"),
        about: "Simulate the log of a robot with a laser scanner in a building, in the format of CARMEN",
        place: Place(Phase::Graphs, 15),
        examples: EXAMPLES,
    };
    run::<Command>(identity, |command| &command.common, write)
}

fn write(command: &Command, context: &mut Context) -> anyhow::Result<Outcome> {
    command.options.check()?;
    for (option, path) in [("--truth", &command.truth), ("--relations", &command.relations)] {
        if let Some(path) = path {
            context.check_further_output(option, path)?;
        }
    }
    let simulated = simulate(&command.options);
    let times = simulated.times();
    let known = relations(&times, &simulated.truth);
    info!("{:.1} m in {}", simulated.path_length(), counted(times.len(), "scan"));
    context.statistics.note("path_length_m", simulated.path_length());
    context.statistics.note("scans", times.len());
    context.statistics.note("walls", simulated.plan.walls.len());
    context.statistics.note("relations", known.len());
    if let Some(path) = &command.truth {
        let poses: Vec<_> = times.iter().copied().zip(simulated.truth.iter().copied()).collect();
        write_atomically(path, |writer| Ok(write_trajectory(&poses, writer)?))?;
    }
    if let Some(path) = &command.relations {
        write_atomically(path, |writer| Ok(write_relations(&known, writer)?))?;
    }
    let mut bytes = Vec::new();
    simulated.write_log(&command.options, &mut bytes)?;
    context.write_bytes(&bytes)?;
    Ok(Outcome::Done)
}

//! The command line of `posecut-simulate-graph`.

use std::process::ExitCode;

use clap::Parser;
use posecut_stage::{
    CommonArguments, Context, Examples, Identity, Outcome, Phase, Place, counted, info, run,
};

use crate::{Options, simulate};

#[derive(Parser)]
struct Command {
    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    ("Draw a graph", "posecut simulate-graph --seed 7 -o graph.jsonl"),
    ("Let corridors repeat themselves", "posecut simulate-graph --incorrect-kind corridor -o graph.jsonl"),
    ("Draw many robots in space", "posecut simulate-graph --dimension 3 --robots 12 -o graph.jsonl.gz"),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "simulate-graph",
        version: env!("CARGO_PKG_VERSION"),
        about: "Simulate a pose graph of which everything is drawn: world, robots, noise, incorrect landmark edges",
        place: Place(Phase::Graphs, 16),
        examples: EXAMPLES,
    };
    run::<Command>(identity, |command| &command.common, write)
}

fn write(command: &Command, context: &mut Context) -> anyhow::Result<Outcome> {
    let mut simulated = simulate(&command.options)?;
    let (correct, incorrect) = (simulated.correct_edges, simulated.incorrect_edges);
    info!(
        "{} of {}, {} and {incorrect} incorrect ones",
        counted(simulated.graph.nodes.len(), "node"),
        counted(simulated.character.robots, "robot"),
        counted(correct, "correct landmark edge"),
    );
    context.statistics.note("nodes", simulated.graph.nodes.len());
    context.statistics.note("correct_edges", correct);
    context.statistics.note("incorrect_edges", incorrect);
    context.statistics.note("character", &simulated.character);
    context.record_provenance(&mut simulated.graph, &simulated.character, Some(command.options.seed))?;
    context.write_graph(&simulated.graph)?;
    Ok(Outcome::Done)
}

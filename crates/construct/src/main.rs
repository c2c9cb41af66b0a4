//! `posecut-construct`: session graphs to a multi-session pose graph.

use std::process::ExitCode;

use clap::Parser;
use posecut_construct::{Options, construct};
use posecut_stage::{CommonArguments, Identity, Outcome, Source, run};

#[derive(Parser)]
struct Command {
    /// Session graphs (JSON Lines, may be compressed); one is split into two experiences, several are joined
    #[arg(value_name = "SESSION", default_value = "-")]
    sessions: Vec<Source>,

    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

fn main() -> ExitCode {
    let identity = Identity {
        name: "construct",
        version: env!("CARGO_PKG_VERSION"),
        about: "Build a multi-session pose graph with correct and incorrect landmark edges",
    };
    run::<Command>(
        identity,
        |command| &command.common,
        |command, context| {
            let graphs = command
                .sessions
                .iter()
                .map(|source| context.read_graph(source, "session"))
                .collect::<anyhow::Result<Vec<_>>>()?;
            let (mut graph, statistics) = construct(graphs, &command.options)?;
            context.statistics = statistics;
            context.record_provenance(&mut graph, &command.options, Some(command.options.seed))?;
            context.write_graph(&graph)?;
            Ok(Outcome::Done)
        },
    )
}

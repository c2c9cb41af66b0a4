//! `posecut-simulate`: simulates a session in NCLT's layouts.

use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::Parser;
use posecut_simulate::{Options, is_session_file, simulate};
use posecut_stage::{CommonArguments, Identity, Outcome, Phase, Place, info, run, write_directory};

#[derive(Parser)]
struct Command {
    #[command(flatten)]
    options: Options,

    /// Replace the output directory if it exists and holds nothing but a simulated session
    #[arg(long)]
    overwrite: bool,

    #[command(flatten)]
    common: CommonArguments,
}

fn main() -> ExitCode {
    let identity = Identity {
        name: "simulate",
        version: env!("CARGO_PKG_VERSION"),
        about: "Simulate a session and write NCLT's files into the directory given by -o, named by the session's date",
        place: Place(Phase::Graphs, 10),
    };
    run::<Command>(
        identity,
        |command| &command.common,
        |command, context| {
            let Some(directory) = command.common.output.path() else {
                bail!(
                    "a session is a directory of files; name it with -o, such as -o data/simulated/2012-01-22"
                );
            };
            let name = directory
                .file_name()
                .map(|name| name.to_string_lossy().into_owned())
                .with_context(|| format!("{}: has no name to call the session by", directory.display()))?;
            command.options.check()?;
            context.statistics = write_directory(directory, command.overwrite, is_session_file, |folder| {
                simulate(folder, &name, &command.options)
            })?;
            info!("simulated session {name} in {}", directory.display());
            Ok(Outcome::Done)
        },
    )
}

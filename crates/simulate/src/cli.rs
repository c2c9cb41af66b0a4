//! The command line of `posecut-simulate`: simulates a session in NCLT's layouts.

use std::io::BufWriter;
use std::path::Path;
use std::process::ExitCode;

use crate::{Options, SessionFile, Summary, is_session_file, simulate};
use anyhow::{Context as _, bail};
use clap::Parser;
use posecut_stage::{
    CommonArguments, Examples, Identity, Outcome, Phase, Place, Statistics, close, info, run, write_directory,
};

#[derive(Parser)]
struct Command {
    #[command(flatten)]
    options: Options,

    /// Replace the output directory if it contains nothing but a simulated session
    #[arg(long)]
    overwrite: bool,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    (
        "Simulate two sessions on the same campus",
        "posecut simulate --seed 1 -o 2012-01-22\nposecut simulate --seed 2 -o 2012-03-31",
    ),
    ("Drive 500 m and back", "posecut simulate --route return --length 1000 -o 2012-01-22"),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "simulate",
        version: env!("CARGO_PKG_VERSION"),
        about: "Simulate a session and write it as NCLT files to the directory given by -o, whose name is the session's date",
        place: Place(Phase::Graphs, 10),
        examples: EXAMPLES,
    };
    run::<Command>(
        identity,
        |command| &command.common,
        |command, context| {
            let Some(directory) = command.common.output.path() else {
                bail!(
                    "a session is a directory, so it cannot go to standard output; name a directory with -o, such as -o data/simulated/2012-01-22"
                );
            };
            let name = directory
                .file_name()
                .map(|name| name.to_string_lossy().into_owned())
                .with_context(|| format!("{}: does not end in a name for the session; end the path in a date, such as 2012-01-22", directory.display()))?;
            command.options.check()?;
            let summary = write_directory(directory, command.overwrite, is_session_file, |folder| {
                let session = simulate(&name, &command.options)?;
                session.files.iter().try_for_each(|file| write(folder, file))?;
                session.scanners.write(folder)?;
                Ok(session.summary)
            })?;
            note(&name, &summary, &mut context.statistics);
            info!("simulated session {name} in {}", directory.display());
            Ok(Outcome::Done)
        },
    )
}

/// Writes a file of the session. Errors name only the file, since the user does not know the temporary folder.
fn write(folder: &Path, file: &SessionFile) -> anyhow::Result<()> {
    let place = || file.name.clone();
    let created = std::fs::File::create(folder.join(&file.name)).with_context(place)?;
    let mut writer = BufWriter::new(created);
    file.write(&mut writer).with_context(place)?;
    let written = writer.into_inner().map_err(std::io::IntoInnerError::into_error).with_context(place)?;
    close(written).with_context(place)
}

fn note(name: &str, summary: &Summary, statistics: &mut Statistics) {
    statistics.note("session", name);
    statistics.note("path_length_m", summary.path_length);
    statistics.note("duration_s", summary.duration);
    statistics.note("stopped_share", summary.stopped_share);
    statistics.note("crossings", summary.crossings);
    statistics.note("paths", summary.paths);
}

//! The command line of `posecut-conform`: checks a program against the contract of posecut's stages.

use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use crate::{Program, check};
use clap::Parser;
use posecut_stage::{CommonArguments, Examples, Identity, Outcome, Phase, Place, run};

/// The format of the report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// For people
    Text,
    /// For programs
    Json,
}

/// `--strict` of all programs has a meaning of its own here, where no doubts arise.
#[derive(Parser)]
#[command(mut_arg("strict", |strict| strict.help("Exit with status 1 for advice too").help_heading(None)))]
struct Command {
    /// The program and its own options, after `--`
    #[arg(value_name = "PROGRAM", last = true, required = true)]
    program: Vec<String>,

    /// Write the report in this format [default: json for an output named .json, text for any other]
    #[arg(long, value_enum)]
    format: Option<Format>,

    /// End a run of the program after this many seconds, and fail its check
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0)]
    time_limit: f64,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    ("Check a stage with its options", "posecut conform -- ./my-stage --my-option 3"),
    ("Write the report as JSON", "posecut conform -o report.json -- ./my-stage"),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "conform",
        version: env!("CARGO_PKG_VERSION"),
        about: "Check a program against the contract of posecut's stages",
        place: Place(Phase::Runs, 20),
        examples: EXAMPLES,
    };
    run::<Command>(
        identity,
        |command| &command.common,
        |command, context| {
            let limit = Duration::try_from_secs_f64(command.time_limit).map_err(|_| {
                anyhow::anyhow!(
                    "--time-limit is {}, but must be a positive number of seconds",
                    command.time_limit
                )
            })?;
            let report = check(&Program::new(command.program.clone(), limit)?)?;
            for (name, value) in report.figures() {
                context.statistics.note(name, value);
            }
            context.statistics.note("checks", &report.checks);
            let by_name = || match command.common.output.path().and_then(Path::extension) {
                Some(extension) if extension == "json" => Format::Json,
                _ => Format::Text,
            };
            let text = match command.format.unwrap_or_else(by_name) {
                Format::Text => report.text(),
                Format::Json => report.json()?,
            };
            context.write_bytes(text.as_bytes())?;
            Ok(if report.conforms(command.common.strict) { Outcome::Done } else { Outcome::CheckFailed })
        },
    )
}

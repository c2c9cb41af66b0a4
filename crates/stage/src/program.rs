//! From `main` to exit status.

use std::io::{self, Write as _};
use std::process::ExitCode;

use anyhow::Context as _;
use clap::{CommandFactory, FromArgMatches};

use crate::{CommonArguments, Context, documentation, interrupt, logging};

/// The name and version of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The stage's name without `posecut-`.
    pub name: &'static str,
    /// Its version.
    pub version: &'static str,
    /// One sentence on what it does.
    pub about: &'static str,
}

/// How a program that did its work ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Exit status 0.
    Done,
    /// Exit status 1: the program worked, and what it checked does not hold.
    CheckFailed,
}

/// Runs a program: reads its command line, does `body`, writes `--stats`, and turns errors into a sentence
/// on standard error and exit status 2.
pub fn run<A: CommandFactory + FromArgMatches>(
    identity: Identity,
    common: impl FnOnce(&A) -> &CommonArguments,
    body: impl FnOnce(&A, &mut Context) -> anyhow::Result<Outcome>,
) -> ExitCode {
    let command = A::command()
        .name(format!("posecut-{}", identity.name))
        .bin_name(format!("posecut-{}", identity.name))
        .version(identity.version)
        .about(identity.about)
        .long_about(None);
    if let Some(what) = documentation::requested(std::env::args_os()) {
        return documentation::print(command, &what);
    }
    let arguments = match command.try_get_matches().and_then(|matches| A::from_arg_matches(&matches)) {
        Ok(arguments) => arguments,
        Err(error) => {
            // Help and version are answers, not errors; a closed pipe does not matter to either.
            let _ = error.print();
            return ExitCode::from(u8::from(error.use_stderr()) * 2);
        }
    };
    let common = common(&arguments).clone();
    logging::install(identity.name, &common);
    interrupt::install();
    let mut context = Context::new(identity, common);
    match execute(&arguments, &mut context, body) {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::CheckFailed) => ExitCode::from(1),
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(io::stderr(), "posecut-{}: error: {error:#}", identity.name);
            ExitCode::from(2)
        }
    }
}

fn execute<A>(
    arguments: &A,
    context: &mut Context,
    body: impl FnOnce(&A, &mut Context) -> anyhow::Result<Outcome>,
) -> anyhow::Result<Outcome> {
    context.check_outputs()?;
    if context.threads() > 0 {
        rayon::ThreadPoolBuilder::new()
            .num_threads(context.threads())
            .build_global()
            .context("the threads cannot be started; try fewer with --threads")?;
    }
    let outcome = match body(arguments, context) {
        // Whoever reads the pipe has seen enough. The work is done, and its summary is wanted all the same.
        Err(error) if is_closed_pipe(&error) => {
            context.statistics.note("output_closed", true);
            Outcome::Done
        }
        outcome => outcome?,
    };
    context.write_statistics()?;
    Ok(outcome)
}

fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        let io_error = cause.downcast_ref::<io::Error>().or_else(|| {
            match cause.downcast_ref::<posecut_graph::WriteError>() {
                Some(posecut_graph::WriteError::Io(error)) => Some(error),
                _ => None,
            }
        });
        io_error.is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
    })
}

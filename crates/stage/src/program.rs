//! From `main` to exit status.

use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};

use crate::closing::close_standard_output;
use crate::given::Given;
use crate::{
    CommonArguments, Context, Doubt, Examples, Place, arguments, documentation, doubt, interrupt, logging,
    standard_output, threads, usage,
};

/// The name and version of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// The stage's name without `posecut-`.
    pub name: &'static str,
    /// Its version.
    pub version: &'static str,
    /// One sentence that says what the program does.
    pub about: &'static str,
    /// The position in lists of programs.
    pub place: Place,
    /// Examples for its long help and its manual page.
    pub examples: Examples,
}

impl Identity {
    /// The program's whole name.
    pub(crate) fn program(&self) -> String {
        format!("posecut-{}", self.name)
    }
}

/// The outcome of a program that did its work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Exit status 0; with `--strict` and doubts, 3.
    Done,
    /// Exit status 0; with doubts 3, also without `--strict`.
    DoneUnlessDoubtful,
    /// Exit status 1: the program worked, but its check failed.
    CheckFailed,
}

/// Runs a program that raises no doubts: parses its command line, calls `body`, and writes `--stats`. An error becomes one
/// sentence on standard error and exit status 2.
pub fn run<A: CommandFactory + FromArgMatches>(
    identity: Identity,
    common: impl FnOnce(&A) -> &CommonArguments,
    body: impl FnOnce(&A, &mut Context) -> anyhow::Result<Outcome>,
) -> ExitCode {
    run_with_doubts(identity, &[], common, body)
}

/// Like [`run`], for a program that may raise these doubts about its result.
pub fn run_with_doubts<A: CommandFactory + FromArgMatches>(
    identity: Identity,
    doubts: &[Doubt],
    common: impl FnOnce(&A) -> &CommonArguments,
    body: impl FnOnce(&A, &mut Context) -> anyhow::Result<Outcome>,
) -> ExitCode {
    let mut command = A::command()
        .name(identity.program())
        .bin_name(identity.program())
        .version(identity.version)
        .about(identity.about)
        .long_about(None)
        .after_help(documentation::ending(doubts))
        .after_long_help(documentation::long_ending(identity.examples, doubts));
    if let Some(what) = documentation::requested(arguments()) {
        return documentation::print(identity, command, doubts, &what);
    }
    let read = command.try_get_matches_from_mut(arguments()).and_then(|matches| {
        let given = Given::of(&command, &matches);
        Ok((A::from_arg_matches(&matches)?, given))
    });
    let (parsed, given) = match read {
        Ok(read) => read,
        Err(error) => return usage::end(&identity.program(), &command, &error),
    };
    let common = common(&parsed).clone();
    logging::install(identity.name, &common);
    interrupt::install();
    let strict = common.strict;
    let mut context = Context::new(identity, common).with_files(given);
    match execute(&parsed, &mut context, body) {
        Ok(outcome @ (Outcome::Done | Outcome::DoneUnlessDoubtful)) => {
            let counts = strict || outcome == Outcome::DoneUnlessDoubtful;
            let doubtful = counts && !context.doubts.is_empty();
            ExitCode::from(if doubtful { doubt::STATUS } else { 0 })
        }
        Ok(Outcome::CheckFailed) => ExitCode::from(1),
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => fail(&identity.program(), &format!("{error:#}")),
    }
}

/// Ends a program with an error: `PROGRAM: error: SENTENCE` on standard error, exit status 2.
pub fn fail(program: &str, sentence: &str) -> ExitCode {
    let _ = writeln!(io::stderr(), "{program}: error: {sentence}");
    ExitCode::from(2)
}

/// Prints an answer such as help to standard output. A closed pipe is no error, because the reader has seen enough; any
/// other failure is.
pub fn answer(program: &str, print: impl FnOnce() -> io::Result<()>) -> ExitCode {
    match standard_output::check()
        .and_then(|()| print())
        .and_then(|()| io::stdout().flush())
        .and_then(|()| close_standard_output())
    {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            fail(program, &format!("standard output: cannot be written: {error}"))
        }
        _ => ExitCode::SUCCESS,
    }
}

fn execute<A>(
    arguments: &A,
    context: &mut Context,
    body: impl FnOnce(&A, &mut Context) -> anyhow::Result<Outcome>,
) -> anyhow::Result<Outcome> {
    context.check_outputs()?;
    context.bound_threads();
    threads::start(context.threads())?;
    let outcome = match body(arguments, context) {
        // The reader of the pipe has seen enough, which is no error. The user still wants the summary.
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

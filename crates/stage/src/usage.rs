//! Errors of the command line. Like all other errors they are one sentence with cause and remedy.

use std::process::ExitCode;

use clap::Command;
use clap::error::ErrorKind;

use crate::program::{answer, fail};

/// Prints help, the version, or the error in a command line.
pub(crate) fn end(program: &str, command: &Command, error: &clap::Error) -> ExitCode {
    if error.use_stderr() {
        return fail(program, &format!("{}; {program} --help lists the options", sentence(command, error)));
    }
    answer(program, || error.print())
}

/// Shortens clap's message of several paragraphs to one line: the cause and its suggestions, without usage.
fn sentence(command: &Command, error: &clap::Error) -> String {
    if error.kind() == ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        let tasks: Vec<&str> =
            command.get_subcommands().map(Command::get_name).filter(|name| *name != "help").collect();
        return format!("the command line names no subcommand; use one of {}", tasks.join(", "));
    }
    let text = error.render().to_string();
    let ends = ["\n\nUsage:", "\n\nFor more information"].map(|end| text.find(end).unwrap_or(text.len()));
    let said = &text[..ends.into_iter().fold(text.len(), usize::min)];
    let one_line = |paragraph: &str| {
        let words: Vec<&str> = paragraph.split_whitespace().filter(|word| *word != "tip:").collect();
        words.join(" ").chars().filter(|character| !character.is_control()).collect::<String>()
    };
    let paragraphs = said.trim_start_matches("error: ").split("\n\n").flat_map(|part| part.split("\n  tip:"));
    paragraphs.map(one_line).filter(|part| !part.is_empty()).collect::<Vec<_>>().join("; ")
}

//! Generates manual pages, shell completions and reference documents: `posecut-STAGE --generate WHAT`.
//!
//! They come from the same description that parses the command line. `--generate` must be the only option, and no help shows
//! it, because only installation and `make documentation` need it.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::process::ExitCode;

use clap::{Arg, ArgAction, Args as _, Command, ValueEnum as _};
use clap_complete::Shell;

use crate::program::{answer, fail};
use crate::{CommonArguments, Description, Doubt, Examples, Identity, Place};

/// The heading of the options that every program has.
const COMMON_HEADING: &str = "Output";

/// An option of every stage from graph to graph.
const DROP_REJECTED: &str = "drop_rejected";

/// The values of `--generate`, for the message that refuses any other.
const KNOWN: &str =
    "man, bash, elvish, fish, powershell, zsh, reference, options, common, doubts or description";

/// The requested document, if the command line is `--generate WHAT` and nothing else.
pub(crate) fn requested(mut arguments: impl Iterator<Item = OsString>) -> Option<String> {
    arguments.next();
    if arguments.next()? != "--generate" {
        return None;
    }
    let what = arguments.next().unwrap_or_default();
    arguments.next().is_none().then(|| what.to_string_lossy().into_owned())
}

pub(crate) fn print(identity: Identity, mut command: Command, doubts: &[Doubt], what: &str) -> ExitCode {
    command.build();
    let text = match what {
        "man" => manual(&command, identity.examples),
        "reference" => reference(&command, doubts).into_bytes(),
        "options" => table_of(&command, |argument| !is_common(argument)).into_bytes(),
        "common" => table(command.get_arguments().filter(|argument| is_common(argument))).into_bytes(),
        "description" => description(identity),
        "doubts" => doubts.iter().flat_map(|doubt| [doubt.name(), "\n"]).collect::<String>().into_bytes(),
        shell => {
            let Ok(shell) = Shell::from_str(shell, false) else {
                return fail(&identity.program(), &format!("--generate {what:?} is unknown; use {KNOWN}"));
            };
            let name = command.get_name().to_owned();
            let mut bytes = Vec::new();
            clap_complete::generate(shell, &mut command, name, &mut bytes);
            bytes
        }
    };
    answer(&identity.program(), || io::stdout().write_all(&text))
}

/// The [`Description`] of a program as one line of JSON.
fn description(identity: Identity) -> Vec<u8> {
    let Identity { name, version, about, place: Place(phase, order), .. } = identity;
    let said = Description { name: name.into(), version: version.into(), about: about.into(), phase, order };
    // A structure of texts and a number always converts to JSON.
    let mut line = serde_json::to_vec(&said).unwrap_or_default();
    line.push(b'\n');
    line
}

/// The manual page, with the options of each subcommand in a section of its own, and the examples in the last one.
fn manual(command: &Command, examples: Examples) -> Vec<u8> {
    let mut page = Vec::new();
    // Its lines would be filled to one paragraph, so it ends as the short help does.
    let man = clap_mangen::Man::new(command.clone().after_long_help(None::<&str>));
    // Writing to memory cannot fail.
    let _ = man.render(&mut page);
    for subcommand in tasks(command) {
        let mut section = Vec::new();
        let man = clap_mangen::Man::new(subcommand.clone().disable_help_flag(true));
        let _ = man.render_description_section(&mut section);
        let _ = man.render_options_section(&mut section);
        let name = subcommand.get_name().to_uppercase();
        let text = String::from_utf8_lossy(&section)
            .replace(".SH DESCRIPTION", &format!(".SH \"{name}\""))
            .replace(".SH OPTIONS", &format!(".SH \"{name}: OPTIONS\""));
        page.extend(text.as_bytes());
    }
    page.extend(examples.manual().as_bytes());
    page
}

fn tasks(command: &Command) -> impl Iterator<Item = &Command> {
    command.get_subcommands().filter(|subcommand| subcommand.get_name() != "help")
}

/// The section of one program in the reference of all programs.
fn reference(command: &Command, doubts: &[Doubt]) -> String {
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let mut text = format!("## {}\n\n{about}.\n\n", command.get_name());
    for usage in usages(command) {
        let _ = writeln!(text, "    {usage}");
    }
    let _ = writeln!(text, "\n{}\n", raised(doubts, "`"));
    text.push_str(&table_of(command, |argument| !is_common(argument)));
    text
}

/// The text below the options in the help.
pub(crate) fn ending(doubts: &[Doubt]) -> String {
    format!(
        "Exit status: 0 done; 1 a check failed; 2 error; 3 done, but the result is doubtful (only with --strict).\n{}",
        raised(doubts, "")
    )
}

/// The text below the options in the long help.
pub(crate) fn long_ending(examples: Examples, doubts: &[Doubt]) -> String {
    [examples.help(), ending(doubts)]
        .into_iter()
        .filter(|part| !part.is_empty())
        .collect::<Vec<_>>()
        .join("\n")
}

/// A sentence on the doubts that a program may raise, with `mark` on both sides of each name.
fn raised(doubts: &[Doubt], mark: &str) -> String {
    if doubts.is_empty() {
        return "This program raises no doubts.".to_owned();
    }
    let names: Vec<String> = doubts.iter().map(|doubt| format!("{mark}{doubt}{mark}")).collect();
    format!("Doubts that this program may raise: {}.", names.join(", "))
}

fn usages(command: &Command) -> Vec<String> {
    let usage = |command: &Command| {
        let text = command.clone().render_usage().to_string();
        text.trim_start_matches("Usage: ").split_whitespace().collect::<Vec<_>>().join(" ")
    };
    if command.has_subcommands() { tasks(command).map(usage).collect() } else { vec![usage(command)] }
}

/// The table of a program's arguments, or one table for each of its subcommands.
fn table_of(command: &Command, keep: impl Fn(&Arg) -> bool) -> String {
    let mut text = table(command.get_arguments().filter(|argument| keep(argument)));
    for subcommand in tasks(command) {
        let about = subcommand.get_about().map(ToString::to_string).unwrap_or_default();
        if !text.is_empty() {
            text.push('\n');
        }
        let _ = write!(text, "`{}`: {about}.\n\n", subcommand.get_name());
        text.push_str(&table(subcommand.get_arguments().filter(|argument| keep(argument))));
    }
    if text.is_empty() { "Only the options of every program.\n".to_owned() } else { text }
}

fn is_common(argument: &Arg) -> bool {
    let every_program = CommonArguments::augment_args(Command::new(""));
    let has = |id| id == DROP_REJECTED || every_program.get_arguments().any(|common| common.get_id() == id);
    // A program's own option may have a common name. Its heading differs.
    argument.get_help_heading() == Some(COMMON_HEADING) && has(argument.get_id())
        || matches!(
            argument.get_action(),
            ArgAction::Help | ArgAction::HelpShort | ArgAction::HelpLong | ArgAction::Version
        )
}

fn table<'a>(arguments: impl Iterator<Item = &'a Arg>) -> String {
    let mut text = String::new();
    for argument in arguments.filter(|argument| !argument.is_hide_set()) {
        if text.is_empty() {
            text.push_str("| argument | default | meaning |\n|---|---|---|\n");
        }
        let _ = writeln!(text, "| {} | {} | {} |", names(argument), default(argument), meaning(argument));
    }
    text
}

fn names(argument: &Arg) -> String {
    let mut values = String::new();
    if argument.get_action().takes_values() {
        let names = argument.get_value_names().unwrap_or_default();
        values = names.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    }
    let many = matches!(argument.get_action(), ArgAction::Append)
        || argument.get_num_args().is_some_and(|count| count.max_values() > 1);
    let more = if many { " …" } else { "" };
    if argument.is_positional() {
        return format!("`{values}{more}`");
    }
    let short = argument.get_short().map(|short| format!("`-{short}`, ")).unwrap_or_default();
    let long = argument.get_long().unwrap_or_default();
    if argument.is_require_equals_set() {
        // The value is optional and follows `=` without a space.
        return format!("{short}`--{long}[={values}]`");
    }
    let gap = if values.is_empty() { "" } else { " " };
    format!("{short}`--{long}{gap}{values}{more}`")
}

fn default(argument: &Arg) -> String {
    if argument.is_required_set() {
        return "needed".to_owned();
    }
    if !argument.get_action().takes_values() {
        return String::new();
    }
    let values: Vec<String> =
        argument.get_default_values().iter().map(|value| format!("`{}`", value.to_string_lossy())).collect();
    if values.is_empty() { "none".to_owned() } else { values.join(" ") }
}

fn meaning(argument: &Arg) -> String {
    let help = argument.get_long_help().or(argument.get_help()).map(ToString::to_string).unwrap_or_default();
    let mut text = help.split_whitespace().collect::<Vec<_>>().join(" ");
    let values: Vec<String> = argument
        .get_possible_values()
        .iter()
        .filter(|value| !value.is_hide_set() && argument.get_action().takes_values())
        .map(|value| {
            let help = value.get_help().map(|help| format!(" ({help})")).unwrap_or_default();
            format!("`{}`{help}", value.get_name())
        })
        .collect();
    if !values.is_empty() {
        let _ = write!(text, ": {}", values.join(", "));
    }
    text.replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(line: &[&str]) -> Option<String> {
        requested(line.iter().map(OsString::from))
    }

    #[test]
    fn only_the_whole_command_line_asks() {
        assert_eq!(asked(&["posecut-pcm", "--generate", "man"]), Some("man".to_owned()));
        assert_eq!(asked(&["posecut-pcm", "--generate", "man", "x"]), None);
        assert_eq!(asked(&["posecut-pcm", "x", "--generate", "man"]), None);
        assert_eq!(asked(&["posecut-pcm"]), None);
    }
}

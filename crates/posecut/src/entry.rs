//! Runs the program that the command line names.

use std::ffi::{OsStr, OsString};
use std::io::{self, Write as _};
use std::process::{Command, ExitCode};

use clap_complete::Shell;
use posecut_stage::registry::{Program, Registry};
use posecut_stage::{answer, fail, hand_over_standard_output, set_arguments};

use crate::built_in;
use crate::listing::{EXAMPLES, help, versions};

/// The program's name in answers and errors.
const NAME: &str = "posecut";

/// Executes the command line, given without the program's own name.
pub fn run(registry: &Registry, mut arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let Some(first) = arguments.next() else { return print(&help(registry)) };
    match first.to_str() {
        Some("help" | "--help" | "-h") => match arguments.next() {
            Some(name) => start(registry, &name, ["--help".into()].into_iter()),
            None => print(&help(registry)),
        },
        Some("version") => print(&versions(registry)),
        Some("--version" | "-V") => print(&format!("posecut {}\n", env!("CARGO_PKG_VERSION"))),
        Some("--generate") => generate(registry, &arguments.next().unwrap_or_default().to_string_lossy()),
        Some(option) if option.starts_with('-') => {
            fail(NAME, &format!("{option} comes before the name of a program; write posecut NAME {option}"))
        }
        _ => start(registry, &first, arguments),
    }
}

fn start(registry: &Registry, name: &OsStr, arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let name = name.to_string_lossy();
    let Some(program) = registry.get(&name) else {
        let meant =
            registry.nearest(&name).map(|known| format!(" (did you mean {known}?)")).unwrap_or_default();
        return fail(
            NAME,
            &format!(
                "there is no program posecut-{name} beside posecut or on the PATH{meant}; posecut help lists the programs"
            ),
        );
    };
    match built_in::get(&name) {
        Some(main) if program.built_in => {
            set_arguments(std::iter::once(format!("posecut-{name}").into()).chain(arguments).collect());
            main()
        }
        _ => become_program(&program, arguments),
    }
}

#[cfg(unix)]
fn become_program(program: &Program, arguments: impl Iterator<Item = OsString>) -> ExitCode {
    use std::os::unix::process::CommandExt as _;
    hand_over_standard_output();
    // Returns only where the program could not be started.
    let error = Command::new(&program.path).args(arguments).exec();
    fail(NAME, &format!("{}: cannot be started: {error}; reinstall it", program.path.display()))
}

#[cfg(not(unix))]
fn become_program(program: &Program, arguments: impl Iterator<Item = OsString>) -> ExitCode {
    match Command::new(&program.path).args(arguments).status() {
        // A program that a signal ended has no exit status.
        Ok(status) => ExitCode::from(status.code().and_then(|code| u8::try_from(code).ok()).unwrap_or(2)),
        Err(error) => {
            fail(NAME, &format!("{}: cannot be started: {error}; reinstall it", program.path.display()))
        }
    }
}

fn print(text: &str) -> ExitCode {
    answer(NAME, || io::stdout().write_all(text.as_bytes()))
}

/// The manual page or a shell's completions, with the names of the available programs.
fn generate(registry: &Registry, what: &str) -> ExitCode {
    use clap::ValueEnum as _;
    let mut command = clap::Command::new(NAME)
        .version(env!("CARGO_PKG_VERSION"))
        .about("Run a posecut program by its name")
        .disable_help_subcommand(true)
        .subcommand(clap::Command::new("help").about("List the programs, or show the help of one"))
        .subcommand(clap::Command::new("version").about("Show the versions of all programs"));
    for program in registry.beside() {
        let about = program.description().map(|description| description.about).unwrap_or_default();
        command = command.subcommand(clap::Command::new(program.name.clone()).about(about));
    }
    let mut bytes = Vec::new();
    match (what, Shell::from_str(what, false)) {
        ("man", _) => {
            // Writing to memory cannot fail.
            let _ = clap_mangen::Man::new(command).render(&mut bytes);
            bytes.extend(EXAMPLES.manual().into_bytes());
        }
        (_, Ok(shell)) => clap_complete::generate(shell, &mut command, NAME, &mut bytes),
        _ => {
            return fail(
                NAME,
                &format!("--generate {what:?} is unknown; use man, bash, elvish, fish, powershell or zsh"),
            );
        }
    }
    answer(NAME, || io::stdout().write_all(&bytes))
}

//! Tests of the examples in long help and manual pages.

use std::process::{Command, Stdio};

use posecut_contract::registry::programs;
use posecut_contract::{program, succeed};
use xtask::documentation::generated;

/// The columns of a terminal. A wrapped line would lose its indentation.
const WIDEST: usize = 80;

/// The examples in a long help: command lines, each with its continuation lines.
fn examples(help: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    let section = help.lines().skip_while(|line| *line != "Examples:").skip(1);
    for line in section.take_while(|line| line.is_empty() || line.starts_with("  ")) {
        assert!(line.chars().count() <= WIDEST, "more than {WIDEST} columns: {line}");
        let Some(command) = line.strip_prefix("    ") else { continue };
        match found.last_mut() {
            Some(open) if open.ends_with(['|', '\\']) => {
                let part = open.trim_end_matches('\\').to_owned();
                *open = part + " " + command.trim_start();
            }
            _ => found.push(command.to_owned()),
        }
    }
    found
}

/// The calls in a command line: the program's name without `posecut-`, and its arguments.
fn calls(line: &str) -> Vec<(String, Vec<String>)> {
    let call = |part: &str| {
        let words: Vec<String> = part.split_whitespace().map(str::to_owned).collect();
        assert_eq!(words[0], "posecut", "{line}");
        (words[1].clone(), words[2..].to_vec())
    };
    line.split('|').map(call).collect()
}

#[test]
fn every_program_has_examples_in_its_long_help_and_its_manual_page() {
    for name in programs() {
        let help = String::from_utf8(succeed(&name, &["--help"], b"")).unwrap();
        let found = examples(&help);
        assert!(!found.is_empty(), "{name}: {help}");
        assert!(
            found.iter().flat_map(|line| calls(line)).any(|(called, _)| called == name),
            "{name}: {found:?}"
        );
        let (before, after) = help.split_once("\nExamples:\n").unwrap();
        assert!(!before.contains("Exit status") && after.contains("Exit status: 0 done"), "{name}: {help}");
        let short = String::from_utf8(succeed(&name, &["-h"], b"")).unwrap();
        assert!(!short.contains("Examples:") && short.contains("Exit status: 0 done"), "{name}: {short}");

        let manual = generated(&program(&name), "man").unwrap();
        assert!(manual.contains("Exit status: 0 done"), "{name}: {manual}");
        let (_, section) =
            manual.split_once("\n.SH EXAMPLES\n").unwrap_or_else(|| panic!("{name}: {manual}"));
        let lines = help_lines(after);
        assert_eq!(section.matches("\nposecut ").count(), lines, "{name}: {section}");
    }
}

/// The lines of examples that start a command.
fn help_lines(section: &str) -> usize {
    section.lines().filter(|line| line.starts_with("    posecut ")).count()
}

/// Runs a program for at most one second of processor time. By then it has read its command line; a simulation that needs longer is
/// ended.
fn shortly(name: &str) -> Command {
    if !cfg!(unix) {
        return Command::new(program(name));
    }
    let mut command = Command::new("sh");
    command.args(["-c", "ulimit -t 1; exec \"$@\"", "sh"]).arg(program(name));
    command
}

/// Runs each call of some examples in a folder without its files: the program must accept the command line, and miss only
/// the files.
fn accepted(examples: &[String], of: &str) {
    for (called, arguments) in examples.iter().flat_map(|line| calls(line)).filter(|(name, _)| name != "help")
    {
        let folder = tempfile::tempdir().unwrap();
        let output = shortly(&called)
            .args(&arguments)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        let refused = said.contains("--help lists the options");
        assert!(!refused, "{of}: the example posecut {called} {arguments:?}: {said}");
    }
}

#[test]
fn programs_accept_the_options_of_their_examples() {
    for name in programs() {
        let help = String::from_utf8(succeed(&name, &["--help"], b"")).unwrap();
        accepted(&examples(&help), &name);
    }
}

#[test]
fn programs_accept_the_options_of_the_examples_of_posecut() {
    let posecut = program("pcm").with_file_name(format!("posecut{}", std::env::consts::EXE_SUFFIX));
    let help = Command::new(posecut).arg("help").output().unwrap().stdout;
    let found = examples(&String::from_utf8(help).unwrap());
    assert!(!found.is_empty());
    accepted(&found, "posecut");
}

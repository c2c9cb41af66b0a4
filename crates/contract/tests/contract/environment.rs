//! Tests that environment variables with hostile values are ignored or give one sentence. docs/environment.md lists them.

#![cfg(unix)]

use std::ffi::{OsStr, OsString};
use std::os::unix::ffi::OsStrExt as _;
use std::process::{Command, Output, Stdio};

use posecut_contract::{long_tests, program, workspace};

use crate::table::streams;
use posecut_contract::registry::{Row, table};

/// The variables that the programs and their libraries read. Regressions: with RAYON_RS_NUM_CPUS = 2^64 - 1, threads were started
/// until memory was full; with an impossible RUST_MIN_STACK no thread could be started, and programs panicked.
const VARIABLES: &[&str] = &[
    "RAYON_NUM_THREADS",
    "RAYON_RS_NUM_CPUS",
    "PATH",
    "TMPDIR",
    "COLUMNS",
    "LINES",
    "TERM",
    "NO_COLOR",
    "CLICOLOR",
    "CLICOLOR_FORCE",
    "RUST_BACKTRACE",
    "RUST_LIB_BACKTRACE",
    "RUST_MIN_STACK",
    "HOME",
    "LANG",
    "LC_ALL",
    "TZ",
];

fn hostile() -> Vec<OsString> {
    let mut values: Vec<OsString> = [
        "",
        "-1",
        "0",
        "a\nb",
        "/nowhere/at all",
        "18446744073709551615",
        "4611686018427387904",
        "1e400",
        "%s%n",
    ]
    .map(OsString::from)
    .into();
    values.push("x".repeat(100_000).into());
    values.push("9".repeat(100_000).into());
    values.push(OsStr::from_bytes(b"\xff\xfe/\xc0").to_owned());
    values
}

/// All hostile values; in the short form every `share`-th, each number beginning with the next one.
fn in_turn(number: usize, share: usize) -> impl Iterator<Item = OsString> {
    let share = if long_tests() { 1 } else { share };
    hostile().into_iter().skip(number % share).step_by(share)
}

fn run(row: &Row, variables: &[&str], value: &OsStr) -> Output {
    let mut command = Command::new(program(row.name));
    command.args(row.arguments()).stdin(Stdio::null());
    for variable in variables {
        command.env(variable, value);
    }
    command.output().unwrap()
}

fn ignored_or_refused(row: &Row, variables: &[&str], value: &OsStr, usual: &[u8]) {
    let output = run(row, variables, value);
    let said = String::from_utf8_lossy(&output.stderr);
    let short: String = value.to_string_lossy().chars().take(30).collect();
    let what = format!("posecut-{} with {variables:?} {short:?}: {}: {said}", row.name, output.status);
    match output.status.code() {
        Some(0) => assert_eq!(output.stdout, usual, "{what}"),
        Some(2) => assert_eq!(said.lines().count(), 1, "{what}"),
        _ => panic!("{what}"),
    }
}

#[test]
fn hostile_variables_are_ignored_or_end_in_a_sentence() {
    // Skip posecut-conform: it waits for the program that it checks.
    for (number, row) in streams().filter(|row| row.name != "conform").enumerate() {
        let usual = run(row, &[], OsStr::new("")).stdout;
        for value in in_turn(number, 3) {
            // Set all variables at once: a failure names the program, which is enough to search further.
            ignored_or_refused(row, VARIABLES, &value, &usual);
        }
    }
    // Set variables one by one, so that none hides another.
    for row in table().iter().filter(|row| row.name == "experiment" || row.name == "pcm") {
        let usual = run(row, &[], OsStr::new("")).stdout;
        for (number, variable) in VARIABLES.iter().enumerate() {
            for value in in_turn(number, 6) {
                ignored_or_refused(row, &[variable], &value, &usual);
            }
        }
    }
}

/// The help is wrapped at the width in COLUMNS.
#[test]
fn help_is_whole_at_any_width() {
    for (number, row) in table().iter().enumerate() {
        for value in in_turn(number, 3) {
            let output =
                Command::new(program(row.name)).arg("--help").env("COLUMNS", &value).output().unwrap();
            let said = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success() && said.contains("--output"), "{}: {said}", row.name);
        }
    }
}

#[test]
fn conform_needs_a_folder_for_temporary_files() {
    let row = table().iter().find(|row| row.name == "conform").unwrap();
    for value in hostile().into_iter().filter(|value| !value.is_empty()) {
        let output = run(row, &["TMPDIR"], &value);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains("TMPDIR") && said.lines().count() == 1, "{said}");
    }
}

/// The document lists every variable that a program reads by name.
#[test]
fn the_document_has_every_variable() {
    let document = std::fs::read_to_string(workspace().join("docs/environment.md")).unwrap();
    for variable in VARIABLES {
        assert!(document.contains(&format!("`{variable}`")), "{variable}");
    }
    let rules = std::fs::read_dir(workspace().join("pipelines")).unwrap().map(|entry| entry.unwrap().path());
    let rules = rules.filter(|path| path.extension().is_some_and(|extension| extension == "mk"));
    for path in rules.chain([workspace().join("Makefile")]) {
        let (file, text) = (path.display(), std::fs::read_to_string(&path).unwrap());
        for line in text.lines() {
            if let Some((name, _)) = line.split_once("?=") {
                assert!(document.contains(&format!("`{}`", name.trim())), "{file}: {name}");
            }
        }
    }
}

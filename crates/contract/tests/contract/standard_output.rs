//! Tests that a standard output that accepts nothing is an error.

#![cfg(target_os = "linux")]

use std::process::{Command, Output, Stdio};

use posecut_contract::program;

use crate::table::streams;
use posecut_contract::registry::table;

/// Options that print an answer without doing any work.
const ANSWERS: &[&[&str]] = &[
    &["--help"],
    &["-h"],
    &["--version"],
    &["--generate", "man"],
    &["--generate", "bash"],
    &["--generate", "options"],
];

fn full(name: &str, arguments: &[String]) -> Output {
    let device = std::fs::File::options().write(true).open("/dev/full").unwrap();
    Command::new(program(name)).args(arguments).stdin(Stdio::null()).stdout(device).output().unwrap()
}

/// Runs a program whose standard output is closed at the start.
fn closed(name: &str, arguments: &[String]) -> Output {
    Command::new("sh")
        .args(["-c", "exec \"$@\" >&-", "sh"])
        .arg(program(name))
        .args(arguments)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

fn unwritten(name: &str, arguments: &[String], output: &Output, part: &str) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{name} {arguments:?}: {said}");
    assert!(
        said.contains("standard output: cannot be written") && said.contains(part),
        "{name} {arguments:?}: {said}"
    );
}

/// Regressions: the error named no path, help and manual pages ended with exit status 0, and output to a closed descriptor was
/// lost silently.
#[test]
fn a_full_or_closed_standard_output_is_an_error() {
    for row in streams() {
        let arguments = row.arguments();
        unwritten(row.name, &arguments, &full(row.name, &arguments), "No space left");
        unwritten(row.name, &arguments, &closed(row.name, &arguments), "it is closed");
    }
    for row in table() {
        for answer in ANSWERS {
            let arguments: Vec<String> = answer.iter().map(|&word| word.to_owned()).collect();
            unwritten(row.name, &arguments, &full(row.name, &arguments), "No space left");
            unwritten(row.name, &arguments, &closed(row.name, &arguments), "it is closed");
        }
    }
}

#[test]
fn a_result_in_a_file_needs_no_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    for row in table().iter().filter(|row| row.name != "conform") {
        let mut arguments = row.arguments();
        arguments.extend(["-o".to_owned(), folder.path().join(row.name).to_str().unwrap().to_owned()]);
        let output = closed(row.name, &arguments);
        assert!(output.status.success(), "{}: {}", row.name, String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn who_closes_the_pipe_of_an_answer_has_seen_enough() {
    for row in table() {
        for answer in ANSWERS {
            let mut child = Command::new(program(row.name))
                .args(*answer)
                .stdout(Stdio::piped())
                .stderr(Stdio::piped())
                .spawn()
                .unwrap();
            drop(child.stdout.take());
            let output = child.wait_with_output().unwrap();
            assert!(output.status.success() && output.stderr.is_empty(), "{} {answer:?}", row.name);
        }
    }
}

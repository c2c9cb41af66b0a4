//! Tests that no output other than the result replaces an input.

#![cfg(unix)]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use posecut_contract::{program, run, samples};

use crate::table::streams;

/// Other names of a file.
fn spellings(file: &Path) -> Vec<PathBuf> {
    let folder = file.parent().unwrap();
    let name = file.file_name().unwrap().to_str().unwrap();
    let (symbolic, hard) = (folder.join(format!("symbolic-{name}")), folder.join(format!("hard-{name}")));
    let _ = std::os::unix::fs::symlink(file, &symbolic);
    let _ = fs::hard_link(file, &hard);
    vec![
        file.to_owned(),
        folder.join("..").join(folder.file_name().unwrap()).join(".").join(name),
        symbolic,
        hard,
    ]
}

fn refused(what: &str, output: &Output, file: &Path, content: &[u8]) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{what}: {said}");
    assert!(said.contains("one would overwrite the other"), "{what}: {said}");
    assert_eq!(fs::read(file).unwrap(), content, "{what}: the input was destroyed");
}

/// Regression: `--stats` with the name of an input replaced the input by the statistics.
#[test]
fn statistics_that_name_an_input_are_refused() {
    for row in streams() {
        let arguments = row.arguments();
        for (position, argument) in
            arguments.iter().enumerate().filter(|(_, argument)| Path::new(argument).is_file())
        {
            if Path::new(argument).extension().is_none() {
                // Skip the program that posecut-conform checks.
                continue;
            }
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join(Path::new(argument).file_name().unwrap());
            let content = fs::read(argument).unwrap();
            fs::write(&file, &content).unwrap();
            let mut arguments = arguments.clone();
            arguments[position] = file.to_str().unwrap().to_owned();
            for other in spellings(&file) {
                let mut words: Vec<&str> = arguments.iter().map(String::as_str).collect();
                words.extend(["--stats", other.to_str().unwrap()]);
                refused(&format!("{} {words:?}", row.name), &run(row.name, &words, b""), &file, &content);
            }
        }
        if let (true, Some(input)) = (row.pipe, row.input) {
            let folder = tempfile::tempdir().unwrap();
            let (file, content) = (folder.path().join("in"), samples().bytes(input));
            fs::write(&file, &content).unwrap();
            let output = Command::new(program(row.name))
                .args(row.arguments)
                .arg("--stats")
                .arg(&file)
                .stdin(fs::File::open(&file).unwrap())
                .stdout(Stdio::null())
                .output()
                .unwrap();
            refused(&format!("{} by standard input", row.name), &output, &file, &content);
        }
    }
}

#[test]
fn other_files_beside_the_result_that_name_an_input_are_refused() {
    let commands: &[(&str, &str, &[&str], &[&str])] = &[
        ("pcm", "graph.jsonl", &[], &["--consistency-graph"]),
        ("multicut", "graph.jsonl", &[], &["--certificate"]),
        ("isam", "graph.jsonl", &[], &["--every", "50", "--estimates"]),
        ("partition", "four.mc", &["solve"], &["--certificate"]),
        // The certificate is an input too.
        ("partition", "four.proof", &["verify"], &[&samples().path("four.mc"), "--output"]),
    ];
    let folder = tempfile::tempdir().unwrap();
    for (name, input, task, options) in commands {
        let (file, content) = (folder.path().join(input), samples().bytes(input));
        fs::write(&file, &content).unwrap();
        for other in spellings(&file) {
            let words = [task, &[file.to_str().unwrap()][..], options, &[other.to_str().unwrap()]].concat();
            refused(&format!("{name} {words:?}"), &run(name, &words, b""), &file, &content);
        }
    }
}

/// A stage's output may replace its input graph. A table or a listing may not.
#[test]
fn only_a_graph_takes_the_place_of_its_input() {
    let folder = tempfile::tempdir().unwrap();
    let (file, content) = (folder.path().join("graph.jsonl"), samples().bytes("graph.jsonl"));
    fs::write(&file, &content).unwrap();
    let path = file.to_str().unwrap();
    for words in [&["info", path, "-o", path][..], &["diff", path, path, "-o", path]] {
        refused(&format!("inspect {words:?}"), &run("inspect", words, b""), &file, &content);
    }
    let output = run("convert", &[path, "--from", "jsonl", "--to", "g2o", "-o", path], b"");
    refused("convert", &output, &file, &content);
    let output = run("oracle", &[path, "-o", path], b"");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_ne!(fs::read(&file).unwrap(), content);
}

/// Regression: `--overwrite` replaced any existing folder.
#[test]
fn a_simulated_session_replaces_nothing_but_a_simulated_session() {
    let folder = tempfile::tempdir().unwrap();
    let session = folder.path().join("2012-01-22");
    let simulate =
        || run("simulate", &["--length", "100", "--overwrite", "-o", session.to_str().unwrap()], b"");
    assert!(simulate().status.success());
    assert!(simulate().status.success());
    let own = session.join("notes.txt");
    fs::write(&own, "precious").unwrap();
    let output = simulate();
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("notes.txt") && said.contains("not replaced"), "{said}");
    assert_eq!(fs::read_to_string(&own).unwrap(), "precious");
    let stats = session.join("wheels.csv");
    fs::remove_file(own).unwrap();
    let words = [
        "--length",
        "100",
        "--overwrite",
        "-o",
        session.to_str().unwrap(),
        "--stats",
        stats.to_str().unwrap(),
    ];
    assert_eq!(run("simulate", &words, b"").status.code(), Some(2));
}

/// A second input from standard input would be empty, and its absence would pass for its content.
#[test]
fn standard_input_is_one_input() {
    let graph = fs::read(samples().path("scans.jsonl")).unwrap();
    for program in ["map", "recognize"] {
        let output = run(program, &["-", "--scans", "-"], &graph);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{program}: {said}");
        assert!(said.contains("only one input can be standard input"), "{program}: {said}");
    }
}

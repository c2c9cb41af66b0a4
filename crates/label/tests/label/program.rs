//! Tests the program: ground truth, zero measurements, and exactly one source of labels.

use std::path::Path;
use std::process::{Command, Output};

const GRAPH: &str = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
{"kind":"node","id":0,"pose":[0,0,0]}
{"kind":"node","id":1,"pose":[10,0,0]}
{"kind":"node","id":2,"pose":[10,10,0]}
{"kind":"odometry","id":0,"from":0,"to":1,"measurement":[10,0,0],"information":[1,0,0,1,0,1]}
{"kind":"odometry","id":1,"from":1,"to":2,"measurement":[0,10,0],"information":[1,0,0,1,0,1]}
{"kind":"landmark","id":2,"from":0,"to":2,"measurement":[10,9,0.1],"information":[1,0,0,1,0,1]}
{"kind":"landmark","id":3,"from":0,"to":2,"measurement":[10,7,0.1],"information":[1,0,0,1,0,1]}
{"kind":"landmark","id":4,"from":0,"to":2,"measurement":[10,9,0.3],"information":[1,0,0,1,0,1]}
"#;

fn label(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_posecut-label"));
    command.current_dir(folder).arg("graph.jsonl").args(arguments).output().unwrap()
}

/// The labels of the three landmark edges, and the whole output.
fn labelled(files: &[(&str, &str)], arguments: &[&str]) -> (Vec<bool>, String) {
    let (output, _folder) = run(files, arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let text = String::from_utf8(output.stdout).unwrap();
    let landmarks = text.lines().filter(|line| line.starts_with("{\"kind\":\"landmark\""));
    (landmarks.map(|line| line.contains("\"correct\":true")).collect(), text)
}

fn refused(files: &[(&str, &str)], arguments: &[&str]) -> String {
    let (output, _folder) = run(files, arguments);
    assert_eq!(output.status.code(), Some(2));
    assert!(output.stdout.is_empty());
    String::from_utf8(output.stderr).unwrap()
}

fn run(files: &[(&str, &str)], arguments: &[&str]) -> (Output, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("graph.jsonl"), GRAPH).unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    (label(folder.path(), arguments), folder)
}

#[test]
fn ground_truth_decides_within_both_tolerances() {
    let within = [true, false, false];
    let (labels, text) = labelled(&[], &["--vertices"]);
    assert_eq!(labels, within);
    assert!(text.contains("\"truth\":{\"pose\":[10,10,0]") && !text.contains("\"id\":1,\"pose\""), "{text}");
    assert_eq!(labelled(&[], &["--vertices", "--tolerance-translation", "inf"]).0, [true, true, false]);
    assert_eq!(labelled(&[], &["--vertices", "--tolerance-rotation", "30"]).0, [true, false, true]);
    // Ground truth from another graph: with poses, and as a chain of odometry.
    let odometry: Vec<&str> = GRAPH.lines().filter(|line| !line.contains("landmark")).collect();
    let chain = odometry.join("\n") + "\n";
    let bare = chain
        .replace(",\"pose\":[0,0,0]", "")
        .replace(",\"pose\":[10,0,0]", "")
        .replace(",\"pose\":[10,10,0]", "");
    assert!(!bare.contains("pose\":"));
    for truth in [&chain, &bare] {
        assert_eq!(labelled(&[("truth.jsonl", truth)], &["--ground-truth", "truth.jsonl"]).0, within);
    }
}

#[test]
fn a_trajectory_is_interpolated_between_its_times() {
    let track = "0, 0, 0, 0\n10, 10, 0, 0\n20, 10, 10, 0\n30, 10, 20, 0\n";
    let files = [("track.csv", track), ("times.txt", "0\n10\n20\n")];
    let options = ["--ground-truth", "track.csv", "--times", "times.txt"];
    assert_eq!(labelled(&files, &options).0, [true, false, false]);
    let said = refused(&files, &[&options[..], &["--longest-silence", "5"]].concat());
    assert!(said.contains("track.csv: has no pose of node 0, an end of landmark 2 (0 2)"), "{said}");
    let told = labelled(&files, &[&options[..], &["--longest-silence", "5", "--unknown-incorrect"]].concat());
    assert_eq!(told.0, [false; 3]);
    let said = refused(&[("track.csv", "0,0,0,0\n0,1,1,1\n"), files[1]], &options);
    assert!(said.contains("track.csv, line 2: the time 0 is not later than the one before"), "{said}");
    let said = refused(&[files[0], ("times.txt", "0\nsoon\n")], &options);
    assert!(said.contains("times.txt, line 2: \"soon\" is not a time"), "{said}");
}

#[test]
fn there_is_one_source_of_labels_and_every_edge_gets_one() {
    assert!(refused(&[], &[]).contains("on 3 of 3 landmark edges (first: landmark 2 (0 2))"));
    assert_eq!(labelled(&[], &["--all-correct"]).0, [true; 3]);
    assert!(refused(&[], &["--all-correct", "--vertices"]).contains("cannot be used with"));
    let said = refused(&[("truth.jsonl", "VERTEX_SE2 0 0 0 0\n")], &["--ground-truth", "truth.jsonl"]);
    assert!(said.contains("truth.jsonl") && said.contains("posecut-convert"), "{said}");
}

#[test]
fn zero_measurements_keep_the_labels_of_the_measured_ones() {
    let (labels, text) = labelled(&[], &["--vertices", "--measurements", "zero"]);
    assert_eq!(labels, [true, false, false]);
    assert_eq!(text.matches("\"measurement\":[0,0,0]").count(), 3, "{text}");
    assert!(text.contains("\"measurement\":[0,10,0]"), "odometry stays");
}

//! Runs posecut-conform, the check for other people's stages, on the stages of this workspace.

use std::thread;

use posecut_contract::{program, run};

const STAGES: &[&str] =
    &["densest", "isam", "islands", "multicut", "optimize", "pcm", "ransac", "verify", "voting"];

#[test]
fn every_stage_from_graph_to_graph_conforms() {
    thread::scope(|scope| {
        for name in STAGES {
            scope.spawn(move || {
                let output = run("conform", &["--strict", "--", program(name).to_str().unwrap()], b"");
                assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
            });
        }
    });
}

#[test]
fn modes_that_reject_by_weights_conform() {
    let optimize = program("optimize");
    for mode in [["--gnc", "--reject-below=0.5"], ["--kernel-landmark=dcs", "--reject-below=0.5"]] {
        let arguments = ["--strict", "--", optimize.to_str().unwrap(), mode[0], mode[1]];
        let output = run("conform", &arguments, b"");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}

#[test]
fn the_oracle_is_reported_to_read_the_truth() {
    let output = run("conform", &["--format", "json", "--", program("oracle").to_str().unwrap()], b"");
    assert_eq!(output.status.code(), Some(1));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let failed: Vec<&str> = report["checks"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|check| check["outcome"] == "failed")
        .map(|check| check["name"].as_str().unwrap())
        .collect();
    assert_eq!(failed, ["blind-without-truth", "blind-to-false-truth"]);
}

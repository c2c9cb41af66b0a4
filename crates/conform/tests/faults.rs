//! Tests that every check fails on a stage with the fault that it must find, and on no other fault.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::thread;
use std::time::Duration;

use posecut_conform::{Outcome, Program, Report, check};

/// The stage with a fault: the example `planted`, which `cargo test` builds.
fn planted() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let folder = test.parent().unwrap().parent().unwrap().join("examples");
    let path = folder.join(format!("planted{}", std::env::consts::EXE_SUFFIX));
    assert!(path.is_file(), "{} is not built; run the tests of the whole crate", path.display());
    path
}

fn report(fault: &str) -> Report {
    let arguments = vec![planted().display().to_string(), fault.to_owned()];
    check(&Program::new(arguments, Duration::from_secs(5)).unwrap()).unwrap()
}

/// Each fault with the checks that must fail because of it.
const FAULTS: &[(&str, &[&str])] = &[
    ("standard-input", &["standard-input"]),
    ("hanging", &["standard-input"]),
    ("dash", &["dash"]),
    ("file", &["file", "output-file", "pipeline-options"]),
    ("output-file", &["output-file"]),
    ("pipeline-options", &["pipeline-options"]),
    ("chatter", &["pipeline-options"]),
    ("no-landmark-edges", &["no-landmark-edges"]),
    ("space", &["space"]),
    ("compressed-input", &["compressed-input"]),
    ("nodes", &["nodes"]),
    ("lost-node", &["nodes"]),
    ("edges", &["edges", "earlier-marks"]),
    ("numbers", &["numbers"]),
    ("unknown-fields", &["unknown-fields"]),
    ("header-fields", &["unknown-fields"]),
    ("unknown-kinds", &["unknown-kinds"]),
    ("earlier-marks", &["earlier-marks"]),
    ("deterministic", &["deterministic"]),
    ("blind-without-truth", &["blind-without-truth"]),
    ("blind-to-false-truth", &["blind-to-false-truth"]),
    ("own-mark", &["own-mark"]),
    ("provenance", &["provenance"]),
    ("empty-input", &["empty-input"]),
    ("no-json", &["no-json", "one-sentence"]),
    ("cut-line", &["cut-line"]),
    ("no-header", &["no-header"]),
    ("other-version", &["other-version"]),
    ("status", &["empty-input", "no-json", "cut-line", "no-header", "other-version"]),
    ("silence", &["empty-input", "no-json", "cut-line", "no-header", "other-version"]),
    ("premature-output", &["empty-input", "no-json", "cut-line", "no-header", "other-version"]),
    ("leftovers", &["empty-input", "no-json", "cut-line", "no-header", "other-version"]),
    ("early-output", &["empty-input", "no-json", "cut-line", "no-header", "other-version"]),
    ("missing-input", &["missing-input"]),
    ("missing-folder", &["missing-folder"]),
    ("full-disk", &["full-disk"]),
    ("not-a-number", &["not-a-number"]),
    ("dangling-edge", &["dangling-edge"]),
    ("double-id", &["double-id"]),
    ("unknown-option", &["unknown-option"]),
    ("one-sentence", &["one-sentence"]),
    ("closed-pipe", &["closed-pipe"]),
    ("canonical-order", &["canonical-order"]),
    ("help", &["help"]),
];

/// Faults that break so much that other checks fail too.
const FAR_REACHING: &[&str] = &[
    "dash",
    "status",
    "silence",
    "premature-output",
    "leftovers",
    "early-output",
    "deterministic",
    "lost-node",
    "missing-folder",
    "file",
];

#[test]
fn the_planted_stage_without_fault_conforms() {
    let report = report("none");
    assert!(report.conforms(true), "{}", report.text());
    assert_eq!(report.rejected, Some((12, 70)));
}

#[test]
fn a_stage_that_tells_its_doubts_with_quiet_conforms() {
    let report = report("doubtful");
    assert!(report.conforms(true), "{}", report.text());
}

#[test]
fn every_fault_is_found_by_the_check_that_is_there_for_it() {
    let found: Vec<_> = thread::scope(|scope| {
        let runs: Vec<_> = FAULTS.iter().map(|(fault, _)| scope.spawn(|| report(fault))).collect();
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    let mut complaints = String::new();
    for ((fault, expected), report) in FAULTS.iter().zip(&found) {
        let failed: BTreeSet<_> = report.failed().into_iter().collect();
        let expected: BTreeSet<_> = expected.iter().copied().collect();
        let found =
            if FAR_REACHING.contains(fault) { expected.is_subset(&failed) } else { expected == failed };
        if !found {
            complaints += &format!("{fault}: expected {expected:?}, failed {failed:?}\n");
        }
    }
    assert!(complaints.is_empty(), "{complaints}");
    let covered: BTreeSet<_> = FAULTS.iter().flat_map(|(_, checks)| checks.iter().copied()).collect();
    let all: BTreeSet<_> = found[0].checks.iter().map(|check| check.name).collect();
    assert_eq!(covered, all, "a check that no planted fault is found by proves nothing");
}

#[test]
fn what_cannot_be_tried_is_skipped_by_name() {
    let report = report("standard-input");
    let skipped = |check: &&posecut_conform::CheckReport| matches!(check.outcome, Outcome::Skipped(_));
    assert_eq!(report.checks.iter().filter(skipped).count(), report.checks.len() - 1);
    assert!(!report.conforms(false) && report.rejected.is_none());
}

#[test]
fn the_report_is_the_same_on_every_run_and_names_no_folder() {
    let (one, other) = (report("missing-input"), report("missing-input"));
    assert_eq!(one, other);
    assert!(one.text().contains("FOLDER/missing.jsonl: No such file"), "{}", one.text());
    let json: serde_json::Value = serde_json::from_str(&one.json().unwrap()).unwrap();
    assert_eq!((&json["format"], &json["conforms"]), (&"posecut-conformance".into(), &false.into()));
    assert_eq!(json["checks"][0]["outcome"], "passed");
}

#[test]
fn a_program_that_is_not_there_is_an_error() {
    let missing = Program::new(vec!["/no/such/program".to_owned()], Duration::from_secs(1)).unwrap();
    assert!(format!("{:#}", check(&missing).unwrap_err()).contains("cannot be started"));
    assert!(Program::new(Vec::new(), Duration::from_secs(1)).is_err());
}

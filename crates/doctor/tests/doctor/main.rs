//! The tests of the examination, in one program: linking takes longer than most of them.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test fails by panicking, and says what it skips"
)]

mod calibration;
mod drives;
mod duplicates;
mod frames;
mod gaps;
mod healthy;
mod information;
mod measurements;
mod odometry;
mod program;
mod real;
mod sessions;
mod spacing;
mod truth;

use posecut_doctor::{Finding, Severity, examine};
use posecut_graph::PoseGraph;

/// The finding of this name.
fn find<'a>(findings: &'a [Finding], name: &str) -> Option<&'a Finding> {
    findings.iter().find(|finding| finding.name == name)
}

/// Demands a finding of this severity, with a remedy unless it is a note, and returns it.
fn found(graph: &PoseGraph, name: &str, severity: Severity) -> Finding {
    let findings = examine(graph);
    let names: Vec<&str> = findings.iter().map(|finding| finding.name).collect();
    let finding = find(&findings, name).unwrap_or_else(|| panic!("no {name} among {names:?}")).clone();
    assert_eq!(finding.severity, severity, "{finding:?}");
    if severity != Severity::Note {
        assert!(!finding.consequence.is_empty() && !finding.remedy.is_empty(), "{finding:?}");
        assert!(finding.title.chars().any(|letter| letter.is_ascii_digit()) || !finding.numbers.is_empty());
    }
    finding
}

/// Demands that there is no finding of this name.
fn absent(graph: &PoseGraph, name: &str) {
    let findings = examine(graph);
    assert_eq!(find(&findings, name), None);
}

/// The names of errors and warnings.
fn problems(graph: &PoseGraph) -> Vec<&'static str> {
    let bad = |finding: &Finding| finding.severity != Severity::Note;
    examine(graph).iter().filter(|finding| bad(finding)).map(|finding| finding.name).collect()
}

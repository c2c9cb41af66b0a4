//! Says what is wrong with a pose graph: each finding with a number, what follows from it, and what to do.
//!
//! [`examine`] does everything; [`examine_with`] uses a verification that is there already. The modules are independent of each other
//! but for `survey`, which prepares the graph for all of them:
//!
//! - `odometry`, `gaps`, `sessions`: chains, what joins them, and what is missing.
//! - `measurements`, `information`, `duplicates`, `spacing`: edges.
//! - `truth`, `calibration`: covariances compared with the truth, and with the loops.
//! - `frames`: poses and axes.
//! - [`chains`]: the chains that the factors of a calibration are for.
//! - [`text`]: findings for people.
//!
//! ```
//! use posecut_graph::PoseGraph;
//! let text = r#"{"kind":"header","format":"posecut","version":1,"dimension":2}
//! {"kind":"node","id":0}
//! {"kind":"node","id":10}
//! {"kind":"landmark","id":0,"from":0,"to":10,"measurement":[1,0,0],"information":[100,0,0,100,0,400]}
//! "#;
//! let graph = PoseGraph::read("example", text.as_bytes())?;
//! let findings = posecut_doctor::examine(&graph);
//! assert!(findings.iter().any(|finding| finding.name == "no-odometry"));
//! # Ok::<(), posecut_graph::ReadError>(())
//! ```

mod calibration;
pub mod chains;
#[cfg(feature = "cli")]
pub mod cli;
mod duplicates;
mod finding;
mod frames;
mod gaps;
mod information;
mod measurements;
mod odometry;
mod sessions;
mod spacing;
mod survey;
pub mod text;
mod truth;
mod words;

use posecut_graph::PoseGraph;
use posecut_verify::Verification;

pub use finding::{Finding, Severity, Topic};

use survey::Survey;

/// Landmark edges up to which [`examine`] estimates the calibration, which takes seconds.
pub const MOST_LANDMARK_EDGES: usize = 20_000;

/// How much an examination may cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Effort {
    /// Estimate the calibration of graphs with up to [`MOST_LANDMARK_EDGES`] landmark edges in use.
    #[default]
    Usual,
    /// Estimate the calibration of any graph.
    Thorough,
}

/// Examines a graph with the usual effort. See [`examine_by`].
pub fn examine(graph: &PoseGraph) -> Vec<Finding> {
    examine_by(graph, Effort::Usual)
}

/// Examines a graph. Edges that a stage has rejected count nowhere. Findings are sorted by severity, then by topic. Verification, for
/// the calibration, takes most of the time.
pub fn examine_by(graph: &PoseGraph, effort: Effort) -> Vec<Finding> {
    let survey = Survey::of(graph);
    if survey.landmark.is_empty() || survey.odometry.is_empty() {
        return sorted(findings(&survey, None));
    }
    if effort == Effort::Usual && survey.landmark.len() > MOST_LANDMARK_EDGES {
        let mut found = findings(&survey, None);
        found.push(calibration::skipped(&survey));
        return sorted(found);
    }
    match calibration::verification(&survey) {
        Ok(verification) => sorted(findings(&survey, Some(&verification))),
        Err(error) => {
            let mut found = findings(&survey, None);
            found.push(calibration::failed(&error));
            sorted(found)
        }
    }
}

/// Examines a graph with a verification of it, or without any calibration. The graph must be as it was before verification marked
/// its edges.
pub fn examine_with(graph: &PoseGraph, verification: Option<&Verification>) -> Vec<Finding> {
    sorted(findings(&Survey::of(graph), verification))
}

fn findings(survey: &Survey<'_>, verification: Option<&Verification>) -> Vec<Finding> {
    let mut found = Vec::new();
    if survey.graph.nodes.is_empty() {
        let title = "the graph has no nodes".to_owned();
        let finding = Finding::new(Severity::Error, Topic::Input, "empty", title);
        found.push(finding.therefore("there is nothing to examine", "check the program that wrote the file"));
        return found;
    }
    history(survey, &mut found);
    odometry::check(survey, &mut found);
    gaps::check(survey, &mut found);
    sessions::check(survey, &mut found);
    measurements::check(survey, &mut found);
    information::check(survey, verification, &mut found);
    duplicates::check(survey, &mut found);
    spacing::check(survey, &mut found);
    truth::check(survey, &mut found);
    if let Some(verification) = verification {
        calibration::check(survey, verification, &mut found);
    }
    frames::check(survey, &mut found);
    found
}

/// Doubts that earlier stages recorded.
fn history(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    let doubts = survey.graph.header.doubts();
    if doubts.is_empty() {
        return;
    }
    let names: Vec<String> =
        doubts.iter().map(|doubt| format!("{} by {}", doubt.doubt, doubt.stage)).collect();
    let title = format!("earlier stages raised doubts: {}", words::listed(&names, 5));
    found.push(
        Finding::new(Severity::Note, Topic::Input, "doubts", title)
            .with("doubts", &doubts)
            .therefore("docs/doubts.md says what they mean", ""),
    );
}

fn sorted(mut findings: Vec<Finding>) -> Vec<Finding> {
    findings.sort_by_key(|finding| (finding.severity, finding.topic));
    findings
}

//! What was found, in ten lines.

use std::collections::BTreeMap;

use posecut_doctor::{Finding, Severity, Topic};
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_stage::{Statistics, counted};
use posecut_verify::Verification;
use posecut_verify::verdict::Verdict;
use serde_json::Value;

use crate::movement::Movement;

/// The input of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// What messages call it.
    pub name: String,
    /// Number of sessions.
    pub sessions: usize,
    /// Number of nodes.
    pub poses: usize,
    /// Number of odometry edges.
    pub odometry: usize,
    /// Number of landmark edges.
    pub landmark: usize,
}

impl Input {
    /// Counts what a graph has.
    pub fn of(name: &str, graph: &PoseGraph) -> Self {
        Self {
            name: name.to_owned(),
            sessions: graph.sessions().len(),
            poses: graph.nodes.len(),
            odometry: graph.edges_of(EdgeKind::Odometry).count(),
            landmark: graph.edges_of(EdgeKind::Landmark).count(),
        }
    }

    /// The line about it.
    pub fn line(&self) -> String {
        format!(
            "{}: {}, {}, {}, {}",
            self.name,
            counted(self.sessions, "session"),
            counted(self.poses, "pose"),
            counted(self.odometry, "odometry edge"),
            counted(self.landmark, "landmark edge")
        )
    }
}

/// The lines about the landmark edges of a graph after all judgement.
pub fn edges(graph: &PoseGraph, verification: Option<&Verification>, keep_undecided: bool) -> Vec<String> {
    let in_use = graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.in_use()).count();
    let mut lines = vec![line("in use", counted(in_use, "landmark edge"))];
    let Some(verification) = verification else {
        lines.push(line("rejected", rejected_by(graph)));
        return lines;
    };
    let undecided = verification.count(Verdict::Undecided);
    lines.push(line("rejected", with_reasons(verification, Verdict::Rejected)));
    let what = match (undecided, keep_undecided) {
        (0, _) => String::new(),
        (_, true) => ", in use".to_owned(),
        (_, false) => ", not in use (--undecided keep uses them)".to_owned(),
    };
    lines.push(line("undecided", with_reasons(verification, Verdict::Undecided) + &what));
    if verification.rejected_before > 0 {
        lines.push(line("earlier", format!("{} rejected in the input", verification.rejected_before)));
    }
    lines.extend(joins(verification));
    lines
}

/// How many joins between sessions are established, what else is possible, and whether odometry is broken.
fn joins(verification: &Verification) -> Vec<String> {
    let mut lines = Vec::new();
    let (proposed, established) = (verification.joins_proposed, verification.joins_established);
    if proposed > 0 {
        let overlap = if established == 0 {
            format!("none is established: nothing is merged ({} proposed)", counted(proposed, "join"))
        } else {
            format!("{established} of {} established", counted(proposed, "proposed join"))
        };
        lines.push(line("overlap", overlap));
    }
    for rival in &verification.rivals {
        let beside = if rival.is_open() {
            "would join sessions that stay apart, because another one would join them differently".to_owned()
        } else {
            format!("joins the same sessions differently, against {:.0} nats", rival.accepted)
        };
        lines.push(line(
            "or else",
            format!(
                "hypothesis {} with {} and {:.0} nats {beside} (--hypothesis {0} applies it)",
                rival.hypothesis,
                counted(rival.edges, "edge"),
                rival.evidence,
            ),
        ));
    }
    if !verification.broken.is_empty() {
        let steps = counted(verification.broken.len(), "step");
        lines.push(line("odometry", format!("broken at {steps}: landmark edges that agree contradict it")));
    }
    lines
}

/// The line about the poses: how the optimisation ended, and how far poses moved.
pub fn poses(movement: Option<Movement>, optimization: &Statistics) -> String {
    let number = |name: &str| optimization.as_map().get(name).and_then(Value::as_f64);
    let cost = number("cost").map_or_else(|| "unknown".to_owned(), posecut_optimize::stage::significant);
    let iterations = number("iterations").unwrap_or(0.0) as usize;
    let ended = match optimization.as_map().get("converged") {
        Some(Value::Bool(true)) => "",
        _ => ", did not converge",
    };
    let moved = movement.map_or_else(
        || "computed; the input has none, or not for all nodes".to_owned(),
        |moved| format!("moved by {:.2} m (median), {:.2} m (most)", moved.median, moved.most),
    );
    line("poses", format!("{moved}; cost {cost} after {}{ended}", counted(iterations, "iteration")))
}

/// What is wrong with the input: errors and warnings of posecut-doctor.
pub fn problems(findings: &[Finding]) -> impl Iterator<Item = &Finding> {
    findings.iter().filter(|found| found.severity < Severity::Note)
}

/// The lines about what is doubtful in the input: the worst problem, and how many others there are.
pub fn doubtful(findings: &[Finding]) -> Vec<String> {
    let mut found: Vec<&Finding> = problems(findings).collect();
    // The spacing matters to the multicut alone.
    found.sort_by_key(|found| (found.severity, found.topic == Topic::Spacing));
    let titles: Vec<&str> = found.iter().map(|found| found.title.as_str()).collect();
    let Some((first, others)) = titles.split_first() else { return Vec::new() };
    let more = match others.len() {
        0 => "posecut doctor says what to do".to_owned(),
        count => format!("and {}; posecut doctor lists them, with remedies", counted(count, "other problem")),
    };
    // Names in the graph may contain control characters.
    let first: String = first.chars().filter(|character| !character.is_control()).collect();
    vec![line("doubtful", first), line("", more)]
}

/// A line of the summary.
pub fn line(name: &str, text: impl AsRef<str>) -> String {
    format!("{name:10} {}", text.as_ref())
}

fn with_reasons(verification: &Verification, verdict: Verdict) -> String {
    let mut reasons: BTreeMap<&str, usize> = BTreeMap::new();
    for finding in verification.findings.iter().filter(|finding| finding.verdict == verdict) {
        *reasons.entry(finding.reason.name()).or_default() += 1;
    }
    listed(verification.count(verdict), &reasons)
}

fn rejected_by(graph: &PoseGraph) -> String {
    let mut stages: BTreeMap<&str, usize> = BTreeMap::new();
    for stage in graph.edges_of(EdgeKind::Landmark).filter_map(|edge| edge.rejected_by.as_deref()) {
        *stages.entry(stage).or_default() += 1;
    }
    listed(stages.values().sum(), &stages)
}

/// `12 (10 contradicted, 2 alone)`.
fn listed(count: usize, parts: &BTreeMap<&str, usize>) -> String {
    let parts: Vec<String> = parts.iter().map(|(name, count)| format!("{count} {name}")).collect();
    if parts.is_empty() { count.to_string() } else { format!("{count} ({})", parts.join(", ")) }
}

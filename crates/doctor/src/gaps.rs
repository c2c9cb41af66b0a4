//! Missing odometry within sessions, and times that jump or decrease.

use posecut_graph::Node;
use posecut_pcm::chain::paths;

use crate::finding::{Finding, Severity, Topic};
use crate::odometry::Neighbours;
use crate::survey::{Session, Survey, median};
use crate::words::{counted, figure, percent};

/// A pause this many times as long as the median one is a jump.
const JUMP: f64 = 10.0;
/// Share of missing steps beyond which odometry is not consecutive at all.
const MOSTLY: f64 = 0.5;

pub(crate) fn check(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    if !survey.odometry.is_empty() {
        found.extend(gaps(survey));
    }
    found.extend(backwards(survey));
    found.extend(jumps(survey));
}

fn label(node: &Node) -> String {
    node.frame
        .map_or_else(|| format!("node {}", node.id), |frame| format!("node {} (frame {frame})", node.id))
}

fn gaps(survey: &Survey<'_>) -> Option<Finding> {
    let ways = Neighbours::of(survey);
    let first = ways.open.first()?;
    let count = ways.open.len();
    let nodes = &survey.graph.nodes;
    let (one, other) = (&nodes[first.nodes.0], &nodes[first.nodes.1]);
    let pieces = paths(survey.graph).len();
    let title = format!(
        "odometry is missing between {count} of {} pairs of consecutive nodes (first: {} and {}); {} in {}",
        ways.pairs,
        label(one),
        label(other),
        counted(survey.sessions.len(), "session"),
        counted(pieces, "piece")
    );
    let as_landmark = ways.open.iter().filter(|open| open.landmark).count();
    let found = Finding::new(Severity::Warning, Topic::Gaps, "odometry-gaps", title)
        .with("gaps", count)
        .with("pairs", ways.pairs)
        .with("pieces", pieces)
        .with("as_landmark", as_landmark)
        .with("first", [one.id, other.id]);
    let remedy = if 2 * as_landmark >= count {
        format!("{as_landmark} of these pairs are joined by landmark edges: write those as odometry edges")
    } else if count as f64 > MOSTLY * ways.pairs as f64 {
        "number the nodes of a session in the order of time, and join each to the next".to_owned()
    } else {
        "add the missing odometry, with a large covariance where the motion is a guess".to_owned()
    };
    Some(found.therefore(
        format!("{} of the steps are missing; each piece is a chain of its own, which only landmark edges join to the others, so posecut-verify can check those edges less well", percent(count, ways.pairs)),
        remedy,
    ))
}

/// Seconds between consecutive nodes of a session that have times, with the nodes.
fn pauses<'a>(survey: &Survey<'a>, session: &Session<'_>) -> Vec<(f64, &'a Node, &'a Node)> {
    let graph = survey.graph;
    let nodes: Vec<&Node> =
        session.nodes.iter().map(|&node| &graph.nodes[node]).filter(|node| node.utime.is_some()).collect();
    let pause = |pair: &[&'a Node]| {
        let (one, other) = (pair[0].utime?, pair[1].utime?);
        Some(((other as f64 - one as f64) / 1e6, pair[0], pair[1]))
    };
    nodes.windows(2).filter_map(pause).collect()
}

fn backwards(survey: &Survey<'_>) -> Option<Finding> {
    let pauses = survey.sessions.iter().flat_map(|session| pauses(survey, session));
    let mut back = pauses.filter(|(seconds, ..)| *seconds < 0.0);
    let (seconds, one, other) = back.next()?;
    let count = 1 + back.count();
    let title = format!(
        "times decrease at {count} steps (first: by {} s from {} to {})",
        figure(-seconds),
        label(one),
        label(other)
    );
    let found = Finding::new(Severity::Warning, Topic::Gaps, "times-decrease", title)
        .with("steps", count)
        .with("first", [one.id, other.id])
        .with("seconds", seconds);
    Some(found.therefore(
        "frames and odometry do not follow time: neighbours in a session are not neighbours on the path",
        "number frames in the order of time, and give times in microseconds UTC",
    ))
}

fn jumps(survey: &Survey<'_>) -> Option<Finding> {
    let mut jumps = Vec::new();
    for session in &survey.sessions {
        let pauses = pauses(survey, session);
        let Some(usual) = median(pauses.iter().map(|pause| pause.0)).filter(|usual| *usual > 0.0) else {
            continue;
        };
        jumps.extend(pauses.into_iter().filter(|pause| pause.0 > JUMP * usual).map(|pause| (pause, usual)));
    }
    let ((seconds, one, other), usual) = *jumps
        .iter()
        .max_by(|one, other| one.0.0.total_cmp(&other.0.0).then(other.0.1.id.cmp(&one.0.1.id)))?;
    let title = format!(
        "time jumps at {} (longest: {} s instead of {} s from {} to {})",
        counted(jumps.len(), "step"),
        figure(seconds),
        figure(usual),
        label(one),
        label(other)
    );
    let found = Finding::new(Severity::Note, Topic::Gaps, "time-jumps", title)
        .with("steps", jumps.len())
        .with("longest", [one.id, other.id])
        .with("seconds", seconds)
        .with("median_seconds", usual);
    Some(found.therefore(
        "the covariance of one odometry step may not cover such a pause",
        "remove the odometry edge if the robot was moved meanwhile",
    ))
}

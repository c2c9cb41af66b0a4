//! Sessions: how many, which of them landmark edges join, and components.

use std::collections::BTreeMap;

use posecut_graph::EdgeKind;
use posecut_graph::connectivity::connected_components;
use serde::Serialize;

use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Seen, Survey};
use crate::words::{counted, listed};

/// Rows of the table of overlaps.
const ROWS: usize = 10;
/// Pairs of sessions in the text.
const SHOWN: usize = 4;

/// Landmark edges in use between two sessions, or within one.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Overlap {
    sessions: [String; 2],
    landmark_edges: usize,
}

pub(crate) fn check(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    if survey.graph.nodes.is_empty() {
        return;
    }
    found.push(summary(survey));
    found.extend(unconnected(survey));
    found.extend(without_overlap(survey));
    found.extend(no_landmark(survey));
    found.extend(rejected(survey));
}

fn overlaps(survey: &Survey<'_>) -> Vec<((usize, usize), usize)> {
    let mut counts: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for edge in &survey.landmark {
        let (one, other) = (survey.places[edge.ends.0].0, survey.places[edge.ends.1].0);
        *counts.entry((one.min(other), one.max(other))).or_default() += 1;
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    // The most first; equal ones stay in the order of sessions.
    counts.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
    counts
}

fn components(survey: &Survey<'_>, kinds: &[&[Seen<'_>]]) -> Vec<usize> {
    let edges = kinds.iter().flat_map(|edges| edges.iter()).map(|edge| edge.ends);
    let mut sizes: Vec<usize> = connected_components(survey.graph.nodes.len(), edges)
        .iter()
        .map(|component| component.nodes.len())
        .collect();
    sizes.sort_unstable_by(|one, other| other.cmp(one));
    sizes
}

fn summary(survey: &Survey<'_>) -> Finding {
    let overlaps = overlaps(survey);
    let count = |within: bool| {
        overlaps
            .iter()
            .filter(|((one, other), _)| (one == other) == within)
            .map(|(_, count)| count)
            .sum::<usize>()
    };
    let (within, between) = (count(true), count(false));
    let all = components(survey, &[&survey.odometry, &survey.landmark]).len();
    let chained = components(survey, &[&survey.odometry]).len();
    let edges = if survey.sessions.len() == 1 {
        counted(within, "landmark edge")
    } else {
        let named = |((one, other), count): &((usize, usize), usize)| {
            format!("{} and {}: {count}", survey.name(*one), survey.name(*other))
        };
        let pairs: Vec<String> =
            overlaps.iter().filter(|((one, other), _)| one != other).map(named).collect();
        let pairs = if pairs.is_empty() { String::new() } else { format!(" ({})", listed(&pairs, SHOWN)) };
        format!("{between} landmark edges between them{pairs}, {within} within")
    };
    let alone = if chained > all { format!(", {chained} by odometry alone") } else { String::new() };
    let title = format!(
        "{}, {edges}; {}{alone}",
        counted(survey.sessions.len(), "session"),
        counted(all, "component")
    );
    let row = |((one, other), landmark_edges): &((usize, usize), usize)| Overlap {
        sessions: [survey.name(*one), survey.name(*other)],
        landmark_edges: *landmark_edges,
    };
    let table: Vec<Overlap> = overlaps.iter().take(ROWS).map(row).collect();
    Finding::new(Severity::Note, Topic::Sessions, "sessions", title)
        .with("sessions", survey.sessions.len())
        .with("within", within)
        .with("between", between)
        .with("overlaps", table)
        .with("components", all)
        .with("components_without_landmark_edges", chained)
}

fn unconnected(survey: &Survey<'_>) -> Option<Finding> {
    let sizes = components(survey, &[&survey.odometry, &survey.landmark]);
    (sizes.len() > 1 && !(survey.odometry.is_empty() && survey.landmark.is_empty())).then(|| {
        let shown: Vec<String> = sizes.iter().map(usize::to_string).collect();
        let title = format!("no edge in use joins {} of the graph (nodes: {})", counted(sizes.len(), "component"), listed(&shown, 5));
        Finding::new(Severity::Warning, Topic::Sessions, "components", title)
            .with("components", sizes.len())
            .with("nodes", &sizes[..sizes.len().min(ROWS)])
            .therefore(
                "their relative poses mean nothing: each is optimised for itself",
                "add landmark edges between them, or look at one component at a time: posecut inspect filter --component 1",
            )
    })
}

fn without_overlap(survey: &Survey<'_>) -> Option<Finding> {
    if survey.sessions.len() < 2 {
        return None;
    }
    let mut joined = vec![false; survey.sessions.len()];
    for ((one, other), _) in overlaps(survey).into_iter().filter(|((one, other), _)| one != other) {
        (joined[one], joined[other]) = (true, true);
    }
    let alone: Vec<String> =
        (0..joined.len()).filter(|&session| !joined[session]).map(|session| survey.name(session)).collect();
    (!alone.is_empty()).then(|| {
        let title = format!(
            "{} of {} sessions have no landmark edge to any other: {}",
            alone.len(),
            survey.sessions.len(),
            listed(&alone, 5)
        );
        Finding::new(Severity::Warning, Topic::Sessions, "sessions-without-overlap", title)
            .with("sessions", &alone)
            .therefore(
                "nothing says where these sessions lie in the map",
                "match them with the others, or process them alone: posecut inspect filter --session NAME",
            )
    })
}

fn no_landmark(survey: &Survey<'_>) -> Option<Finding> {
    (survey.landmark.is_empty() && !survey.odometry.is_empty()).then(|| {
        let title = format!(
            "{} and no landmark edge (loop closure) in use",
            counted(survey.odometry.len(), "odometry edge")
        );
        let found = Finding::new(Severity::Warning, Topic::Sessions, "no-landmark-edges", title);
        found.with("odometry_edges", survey.odometry.len()).therefore(
            "there is nothing to judge: the map is dead reckoning",
            "add the matches of a place recogniser: posecut convert --closures TABLE.csv",
        )
    })
}

/// Landmark edges that earlier stages rejected.
fn rejected(survey: &Survey<'_>) -> Option<Finding> {
    let mut by_stage: BTreeMap<&str, usize> = BTreeMap::new();
    for edge in survey.graph.edges_of(EdgeKind::Landmark) {
        if let Some(stage) = &edge.rejected_by {
            *by_stage.entry(stage).or_default() += 1;
        }
    }
    let count: usize = by_stage.values().sum();
    let names: Vec<String> = by_stage.iter().map(|(stage, count)| format!("{count} by {stage}")).collect();
    (count > 0).then(|| {
        let title = format!("{} rejected already ({})", counted(count, "landmark edge"), listed(&names, 5));
        Finding::new(Severity::Note, Topic::Sessions, "rejected-edges", title)
            .with("edges", count)
            .with("by", &by_stage)
            .therefore("they count nowhere below", "")
    })
}

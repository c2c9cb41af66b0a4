//! Distances between candidates in frames, which decide whether the multicut finds support for them.

use std::collections::BTreeMap;

use posecut_graph::{Header, Node, PoseGraph};
use posecut_multicut::delta::Delta;
use posecut_multicut::support::{Support, support};
use serde::Serialize;

use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Seen, Survey, median};
use crate::words::{counted, percent};

/// Pairs of sessions in the table.
const ROWS: usize = 10;
/// Fewer candidates say nothing about their spacing.
const FEWEST: usize = 10;

/// The spacing of candidates between two sessions, or within one.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Spacing {
    sessions: [String; 2],
    candidates: usize,
    /// Median distance between consecutive candidates at the denser end, frames.
    median: Option<f64>,
    /// What `--delta auto` takes from these candidates alone.
    delta: u32,
}

pub(crate) fn check(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    if survey.landmark.is_empty() {
        return;
    }
    match supports(survey.graph) {
        Some((one, auto)) => found.push(finding(survey, &one, &auto)),
        None => found.push(without_frames(survey)),
    }
}

/// Support within one frame, and within the spacing.
fn supports(graph: &PoseGraph) -> Option<(Support, Support)> {
    Some((support(graph, Delta::Frames(1)).ok()?, support(graph, Delta::Auto).ok()?))
}

fn unsupported(support: &Support) -> usize {
    support.counts.iter().filter(|(_, count)| *count == 0).count()
}

fn without_frames(survey: &Survey<'_>) -> Finding {
    let nodes = &survey.graph.nodes;
    let without = nodes.iter().filter(|node| node.session_frame().is_none()).count();
    let title = format!("{} of {} have no session or no frame", without, counted(nodes.len(), "node"));
    Finding::new(Severity::Note, Topic::Spacing, "no-frames", title)
        .with("nodes", without)
        .therefore(
            "posecut-multicut finds neighbours by frames and refuses the graph; posecut-verify does not need them",
            "number the frames of every session",
        )
}

fn finding(survey: &Survey<'_>, one: &Support, auto: &Support) -> Finding {
    let candidates = one.counts.len();
    let (alone, alone_auto) = (unsupported(one), unsupported(auto));
    let [least, most] = auto.deltas.unwrap_or([1, 1]);
    let delta = if least == most { least.to_string() } else { format!("{least} to {most}") };
    let table = table(survey);
    let gap = table.first().and_then(|row| row.median);
    let spaced = gap.map_or_else(String::new, |gap| {
        format!("{gap} {} apart (median), ", if gap == 1.0 { "frame" } else { "frames" })
    });
    let title = format!(
        "{}: {spaced}{alone} ({}) without another one within 1 frame; --delta auto takes {delta}, which leaves {alone_auto} without",
        counted(candidates, "candidate"),
        percent(alone, candidates)
    );
    // Support is the multicut's only evidence. A larger delta must really help before the spacing is to blame.
    let spaced_out = candidates >= FEWEST && 2 * alone > candidates && 2 * alone_auto <= alone;
    let severity = if spaced_out { Severity::Warning } else { Severity::Note };
    let found = Finding::new(severity, Topic::Spacing, "spacing", title)
        .with("candidates", candidates)
        .with("without_support_at_1", alone)
        .with("without_support_at_auto", alone_auto)
        .with("delta_auto", [least, most])
        .with("pairs", table);
    if spaced_out {
        found.therefore(
            "posecut-multicut with its default --delta 1 rejects these for lack of support, correct ones too; posecut-verify does not depend on the spacing",
            format!("use posecut-verify, or posecut-multicut --delta auto (here {delta})"),
        )
    } else {
        found
    }
}

/// The pairs of sessions with most candidates.
fn table(survey: &Survey<'_>) -> Vec<Spacing> {
    let mut pairs: BTreeMap<(usize, usize), Vec<&Seen<'_>>> = BTreeMap::new();
    for edge in &survey.landmark {
        let (one, other) = (survey.places[edge.ends.0].0, survey.places[edge.ends.1].0);
        pairs.entry((one.min(other), one.max(other))).or_default().push(edge);
    }
    let mut pairs: Vec<_> = pairs.into_iter().collect();
    pairs.sort_by_key(|(_, edges)| std::cmp::Reverse(edges.len()));
    pairs.truncate(ROWS);
    pairs
        .into_iter()
        .map(|((one, other), edges)| Spacing {
            sessions: [survey.name(one), survey.name(other)],
            candidates: edges.len(),
            median: spacing(survey, &edges),
            delta: delta(survey.graph, &edges),
        })
        .collect()
}

/// The smaller median gap of both ends, between consecutive distinct frames.
fn spacing(survey: &Survey<'_>, edges: &[&Seen<'_>]) -> Option<f64> {
    let nodes = &survey.graph.nodes;
    let end = |index: usize| Some((survey.places[index].0, nodes[index].frame?));
    let mut ends: [Vec<i64>; 2] = Default::default();
    for edge in edges {
        let (Some(one), Some(other)) = (end(edge.ends.0), end(edge.ends.1)) else { continue };
        ends[0].push(one.min(other).1);
        ends[1].push(one.max(other).1);
    }
    let gap = |mut frames: Vec<i64>| {
        frames.sort_unstable();
        frames.dedup();
        median(frames.windows(2).map(|pair| pair[1].abs_diff(pair[0]) as f64))
    };
    ends.into_iter().filter_map(gap).min_by(f64::total_cmp)
}

/// What `--delta auto` takes from these candidates alone.
fn delta(graph: &PoseGraph, edges: &[&Seen<'_>]) -> u32 {
    let mut part = PoseGraph::new(Header::new(graph.header.dimension));
    for index in edges.iter().flat_map(|edge| [edge.ends.0, edge.ends.1]) {
        let Node { id, session, frame, .. } = &graph.nodes[index];
        part.nodes.push(Node { id: *id, session: session.clone(), frame: *frame, ..Node::default() });
    }
    part.nodes.sort_by_key(|node| node.id);
    part.nodes.dedup_by_key(|node| node.id);
    part.edges = edges.iter().map(|edge| edge.edge.clone()).collect();
    support(&part, Delta::Auto).ok().and_then(|support| support.deltas).map_or(1, |[least, _]| least)
}

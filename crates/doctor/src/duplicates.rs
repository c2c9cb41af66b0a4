//! Nodes and edges that occur twice.

use std::collections::BTreeMap;

use posecut_graph::Node;

use crate::finding::{Finding, Severity, Topic};
use crate::survey::{Seen, Survey};
use crate::words::counted;

/// Share of edges that makes a habit of repeating.
const HABIT: f64 = 0.05;

pub(crate) fn check(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    found.extend(landmark(survey));
    found.extend(odometry(survey));
    found.extend(beside_odometry(survey));
    found.extend(frames(survey));
    found.extend(times(survey));
}

type Groups<'s, 'a> = BTreeMap<(usize, usize), Vec<&'s Seen<'a>>>;

/// Edges by their ends, in either direction.
fn by_ends<'s, 'a>(edges: &'s [Seen<'a>]) -> Groups<'s, 'a> {
    let mut groups: Groups<'_, '_> = BTreeMap::new();
    for edge in edges {
        let (from, to) = edge.ends;
        groups.entry((from.min(to), from.max(to))).or_default().push(edge);
    }
    groups
}

fn landmark(survey: &Survey<'_>) -> Option<Finding> {
    let groups = by_ends(&survey.landmark);
    let mut repeated = groups.values().filter(|group| group.len() > 1);
    let surplus: usize = groups.values().map(|group| group.len() - 1).sum();
    let first = repeated.next()?;
    let pairs = 1 + repeated.count();
    let copies: usize = groups.values().map(|group| copies(group)).sum();
    let copied = match copies {
        0 => String::new(),
        all if all == surplus => ", with the same measurement".to_owned(),
        some => format!(", {some} of them with the same measurement"),
    };
    let title = format!(
        "{} between nodes that another one joins already{copied} (first: edges {} and {})",
        counted(surplus, "landmark edge"),
        first[0].edge.id,
        first[1].edge.id
    );
    // A few may well be measured twice.
    let habit = (surplus as f64) >= HABIT * survey.landmark.len() as f64;
    let severity = if copies > 0 || habit { Severity::Warning } else { Severity::Note };
    let found = Finding::new(severity, Topic::Duplicates, "repeated-landmark-edges", title)
        .with("edges", surplus)
        .with("pairs", pairs)
        .with("copies", copies)
        .with("first", [first[0].edge.id, first[1].edge.id]);
    Some(found.therefore(
        "if one match was written twice, it counts as two that confirm each other",
        "keep one edge for each pair of nodes unless they were measured independently",
    ))
}

/// How many edges of a group repeat the measurement of an earlier one.
fn copies(group: &[&Seen<'_>]) -> usize {
    let same = |one: &Seen<'_>, other: &Seen<'_>| {
        one.edge.from == other.edge.from
            && one.edge.measurement.is_some()
            && one.edge.measurement == other.edge.measurement
    };
    (1..group.len()).filter(|&later| group[..later].iter().any(|earlier| same(earlier, group[later]))).count()
}

fn odometry(survey: &Survey<'_>) -> Option<Finding> {
    let groups = by_ends(&survey.odometry);
    let mut repeated = groups.values().filter(|group| group.len() > 1);
    let first = repeated.next()?;
    let pairs = 1 + repeated.count();
    let title = format!(
        "several odometry edges join {} (first: edges {} and {})",
        if pairs == 1 { "1 pair of nodes".to_owned() } else { format!("{pairs} pairs of nodes") },
        first[0].edge.id,
        first[1].edge.id
    );
    let found = Finding::new(Severity::Warning, Topic::Duplicates, "repeated-odometry-edges", title)
        .with("pairs", pairs)
        .with("first", [first[0].edge.id, first[1].edge.id]);
    Some(found.therefore(
        "chains of odometry use the edge of lowest id; the optimiser uses all of them, so a copy counts twice",
        "keep one odometry edge for each step, or combine their measurements",
    ))
}

/// Landmark edges between nodes that odometry joins.
fn beside_odometry(survey: &Survey<'_>) -> Option<Finding> {
    let odometry = by_ends(&survey.odometry);
    let beside = by_ends(&survey.landmark);
    let mut beside = beside.iter().filter(|(ends, _)| odometry.contains_key(ends));
    let (_, first) = beside.next()?;
    let count = first.len() + beside.map(|(_, group)| group.len()).sum::<usize>();
    let title = format!(
        "{} between nodes that odometry joins already (first: edge {})",
        counted(count, "landmark edge"),
        first[0].edge.id
    );
    let found = Finding::new(Severity::Note, Topic::Duplicates, "landmark-beside-odometry", title)
        .with("edges", count)
        .with("first", first[0].edge.id);
    Some(found.therefore(
        "they measure a step again and close no loop, but count as correct candidates",
        "remove them if they are copies of the odometry",
    ))
}

/// Nodes of equal key, first by node: number of surplus nodes, and the first two.
fn equal<'a, K: Ord>(
    survey: &Survey<'a>,
    key: impl Fn(&Node) -> Option<K>,
) -> Option<(usize, &'a Node, &'a Node)> {
    let mut first: BTreeMap<(usize, K), usize> = BTreeMap::new();
    let (mut count, mut example) = (0, None);
    for (index, node) in survey.graph.nodes.iter().enumerate() {
        let Some(key) = key(node) else { continue };
        let earlier = *first.entry((survey.places[index].0, key)).or_insert(index);
        if earlier != index {
            count += 1;
            example.get_or_insert((earlier, index));
        }
    }
    example.map(|(one, other)| (count, &survey.graph.nodes[one], &survey.graph.nodes[other]))
}

fn frames(survey: &Survey<'_>) -> Option<Finding> {
    let (count, one, other) = equal(survey, |node| node.frame)?;
    let title = format!(
        "{} with the frame of another one in their session (first: nodes {} and {}, frame {})",
        counted(count, "node"),
        one.id,
        other.id,
        one.frame.unwrap_or_default()
    );
    let found = Finding::new(Severity::Warning, Topic::Duplicates, "repeated-frames", title)
        .with("nodes", count)
        .with("first", [one.id, other.id]);
    Some(found.therefore(
        "neighbours are found by frames: posecut-multicut takes both nodes for one, and counts their edges as one",
        "number the frames of a session 0, 1, 2, …, or give the copies a session of their own",
    ))
}

fn times(survey: &Survey<'_>) -> Option<Finding> {
    let (count, one, other) = equal(survey, |node| node.utime)?;
    let title = format!(
        "{} with the time of another one in their session (first: nodes {} and {})",
        counted(count, "node"),
        one.id,
        other.id
    );
    let found = Finding::new(Severity::Warning, Topic::Duplicates, "repeated-times", title)
        .with("nodes", count)
        .with("first", [one.id, other.id]);
    Some(found.therefore(
        "one image became two nodes, or times are rounded; matches of the copies count as independent evidence",
        "remove one node of each pair, or write times in full microseconds",
    ))
}

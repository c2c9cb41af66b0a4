//! Odometry: found at all, between consecutive nodes, along chains.

use std::collections::HashSet;

use posecut_graph::{EdgeKind, PoseGraph, for_dimension};
use posecut_pcm::chain::{Chains, Covariances};

use crate::finding::{Finding, Severity, Topic};
use crate::survey::Survey;
use crate::words::{counted, listed, percent};

pub(crate) fn check(survey: &Survey<'_>, found: &mut Vec<Finding>) {
    let ways = Neighbours::of(survey);
    if survey.odometry.is_empty() {
        found.extend(none(survey, &ways));
        return;
    }
    found.push(summary(survey, &ways));
    found.extend(sessions_without(survey, &ways));
    found.extend(stray(survey));
    found.extend(branches(survey));
    found.extend(rejected(survey));
}

/// How consecutive nodes of sessions are joined.
pub(crate) struct Neighbours {
    /// Pairs of consecutive nodes, over all sessions.
    pub(crate) pairs: usize,
    /// Pairs that odometry in use joins.
    pub(crate) joined: usize,
    /// Pairs without odometry, as indices of nodes, with their session.
    pub(crate) open: Vec<Open>,
}

/// Two consecutive nodes without odometry.
pub(crate) struct Open {
    pub(crate) session: usize,
    pub(crate) nodes: (usize, usize),
    /// Whether a landmark edge in use joins them.
    pub(crate) landmark: bool,
}

impl Neighbours {
    pub(crate) fn of(survey: &Survey<'_>) -> Self {
        let pairs_of = |edges: &[crate::survey::Seen<'_>]| -> HashSet<(usize, usize)> {
            edges.iter().map(|edge| (edge.ends.0.min(edge.ends.1), edge.ends.0.max(edge.ends.1))).collect()
        };
        let (odometry, landmark) = (pairs_of(&survey.odometry), pairs_of(&survey.landmark));
        let mut ways = Self { pairs: 0, joined: 0, open: Vec::new() };
        for (session, of) in survey.sessions.iter().enumerate() {
            for pair in of.nodes.windows(2) {
                ways.pairs += 1;
                let ends = (pair[0].min(pair[1]), pair[0].max(pair[1]));
                if odometry.contains(&ends) {
                    ways.joined += 1;
                } else {
                    let landmark = landmark.contains(&ends);
                    ways.open.push(Open { session, nodes: (pair[0], pair[1]), landmark });
                }
            }
        }
        ways
    }
}

/// The step between ids, if all have the same and it is not 1.
fn stride(graph: &PoseGraph) -> Option<u64> {
    let mut steps = graph.nodes.windows(2).map(|pair| pair[1].id.abs_diff(pair[0].id));
    let first = steps.next()?;
    (first > 1 && steps.all(|step| step == first)).then_some(first)
}

fn none(survey: &Survey<'_>, ways: &Neighbours) -> Option<Finding> {
    let nodes = survey.graph.nodes.len();
    if nodes < 2 {
        return None;
    }
    let found = |severity, title: String| {
        Finding::new(severity, Topic::Odometry, "no-odometry", title)
            .with("nodes", nodes)
            .with("stride", stride(survey.graph))
    };
    if survey.landmark.is_empty() {
        return Some(found(Severity::Error, format!("{nodes} nodes and no edges: a trajectory, not a graph")).therefore(
            "there is nothing to judge and nothing to optimise",
            "read a file with edges, or make them: --odometry-from-poses, and --closures for a table of place matches (also of posecut-convert)",
        ));
    }
    let as_landmark = ways.open.iter().filter(|open| open.landmark).count();
    let ids = stride(survey.graph).map_or_else(String::new, |stride| format!("; ids count by {stride}"));
    let title = format!(
        "no odometry edge; landmark edges join {as_landmark} of {} pairs of consecutive nodes{ids}",
        ways.pairs
    );
    let consequence = "every node is a chain of its own: nothing predicts where a landmark edge should lead, so wrong ones cannot be found";
    let remedy = if 2 * as_landmark >= ways.pairs {
        "convert the original file again with posecut convert --odometry next-id: these edges are the odometry"
    } else {
        "add odometry edges between consecutive nodes (kind \"odometry\", or in g2o edges between ids n and n + 1)"
    };
    let found = found(Severity::Error, title).with("as_landmark", as_landmark).with("pairs", ways.pairs);
    Some(found.therefore(consequence, remedy))
}

fn summary(survey: &Survey<'_>, ways: &Neighbours) -> Finding {
    let counts = stride(survey.graph).map_or_else(String::new, |stride| {
        format!("; ids count by {stride}, so odometry was found by the next id")
    });
    let title = format!(
        "{}, between {} of {} pairs of consecutive nodes{counts}",
        counted(survey.odometry.len(), "odometry edge"),
        ways.joined,
        ways.pairs
    );
    Finding::new(Severity::Note, Topic::Odometry, "odometry", title)
        .with("edges", survey.odometry.len())
        .with("joined", ways.joined)
        .with("pairs", ways.pairs)
        .with("stride", stride(survey.graph))
}

/// Sessions of several nodes without any odometry, where other sessions have some.
fn sessions_without(survey: &Survey<'_>, ways: &Neighbours) -> Option<Finding> {
    let mut open = vec![0; survey.sessions.len()];
    let mut landmark = vec![0; survey.sessions.len()];
    for pair in &ways.open {
        open[pair.session] += 1;
        landmark[pair.session] += usize::from(pair.landmark);
    }
    let without: Vec<usize> = (0..survey.sessions.len())
        .filter(|&session| open[session] > 0 && open[session] + 1 == survey.sessions[session].nodes.len())
        .collect();
    if without.is_empty() {
        return None;
    }
    let names: Vec<String> = without.iter().map(|&session| survey.name(session)).collect();
    let title = format!(
        "{} of {} sessions have no odometry between consecutive nodes: {}",
        without.len(),
        survey.sessions.len(),
        listed(&names, 5)
    );
    let joined: usize = without.iter().map(|&session| landmark[session]).sum();
    let remedy = if joined > 0 {
        "convert the original file again with posecut convert --odometry next-id: landmark edges join these nodes"
    } else {
        "add odometry edges between consecutive nodes"
    };
    let found = Finding::new(Severity::Warning, Topic::Odometry, "sessions-without-odometry", title)
        .with("sessions", names)
        .with("as_landmark", joined);
    Some(found.therefore("nothing predicts where landmark edges of these sessions should lead", remedy))
}

/// Odometry between sessions.
fn stray(survey: &Survey<'_>) -> Option<Finding> {
    let between =
        |edge: &&crate::survey::Seen<'_>| survey.places[edge.ends.0].0 != survey.places[edge.ends.1].0;
    let mut stray = survey.odometry.iter().filter(between);
    let first = stray.next()?;
    let count = 1 + stray.count();
    let title = format!(
        "{} between different sessions (first: edge {} from node {} to {})",
        counted(count, "odometry edge"),
        first.edge.id,
        first.edge.from,
        first.edge.to
    );
    let found = Finding::new(Severity::Warning, Topic::Odometry, "odometry-between-sessions", title)
        .with("edges", count)
        .with("first", first.edge.id);
    Some(found.therefore(
        "odometry is never judged; if these edges are place matches, wrong ones stay in the map",
        "write them as landmark edges, or give both ends one session name",
    ))
}

/// Odometry that fits into no chain.
fn branches(survey: &Survey<'_>) -> Option<Finding> {
    let left_out = for_dimension!(survey.graph.header.dimension, |G, DOF| {
        Chains::<G, DOF>::with(survey.graph, Covariances::Ignored).map_or(0, |chains| chains.left_out)
    });
    (left_out > 0).then(|| {
        let share = percent(left_out, survey.odometry.len());
        let title = format!(
            "{} ({share}) branch off or close a ring",
            counted(left_out, "odometry edge")
        );
        Finding::new(Severity::Warning, Topic::Odometry, "odometry-branches", title)
            .with("edges", left_out)
            .therefore(
                "chains of odometry use one edge from each node to the next and ignore these; the optimiser uses them unjudged",
                "write edges that skip nodes or return to old ones as landmark edges, and keep one odometry edge for each step",
            )
    })
}

/// Odometry that a stage has rejected.
fn rejected(survey: &Survey<'_>) -> Option<Finding> {
    let mut rejected = survey.graph.edges_of(EdgeKind::Odometry).filter(|edge| !edge.in_use());
    let first = rejected.next()?;
    let count = 1 + rejected.count();
    let title = format!("{} rejected (first: edge {})", counted(count, "odometry edge"), first.id);
    let found = Finding::new(Severity::Warning, Topic::Odometry, "odometry-rejected", title)
        .with("edges", count)
        .with("first", first.id);
    Some(found.therefore(
        "the sessions fall into pieces there",
        "remove the field rejected_by from odometry edges unless the odometry is really broken there",
    ))
}

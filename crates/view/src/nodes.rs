//! The nodes as the page stores them, and the odometry between them.

use std::collections::HashMap;

use posecut_graph::{EdgeKind, PoseGraph};
use serde::Serialize;

use crate::columns::shortened;
use crate::encode::{Whole, bits, differences};

/// Nodes in the order of the graph.
#[derive(Debug, Serialize)]
pub(crate) struct Nodes {
    count: usize,
    /// Ids; absent if they count from 0.
    id: Option<Whole>,
    /// Session names in the order of their first node.
    sessions: Vec<String>,
    /// Where runs of nodes of one session begin.
    starts: String,
    /// For each run the session, counted from 1; 0 is none.
    session: String,
    /// Frames; absent if no node has one. Where a node has none, the number means nothing.
    frame: Option<Whole>,
    /// Which nodes have a frame; absent if all have one.
    framed: Option<String>,
    /// For each node whether odometry in use joins it to the node before.
    joined: String,
    /// The other odometry edges in use: indices of their nodes.
    from: String,
    to: String,
}

impl Nodes {
    pub(crate) fn of(graph: &PoseGraph) -> Self {
        let nodes = &graph.nodes;
        let counting = (0..).zip(nodes).all(|(index, node)| node.id == index);
        let ids: Vec<u64> = nodes.iter().map(|node| node.id).collect();
        let frames: Vec<i64> = nodes.iter().map(|node| node.frame.unwrap_or(0)).collect();
        let all = nodes.iter().all(|node| node.frame.is_some());
        let (sessions, starts, session) = runs(graph);
        let (joined, others) = odometry(graph);
        Self {
            count: nodes.len(),
            id: (!counting).then(|| Whole::of(&ids)),
            sessions,
            starts: differences(starts),
            session: differences(session),
            frame: nodes.iter().any(|node| node.frame.is_some()).then(|| Whole::of_signed(&frames)),
            framed: (!all).then(|| bits(nodes.iter().map(|node| node.frame.is_some()))),
            joined: bits(joined),
            from: differences(others.iter().map(|(from, _)| *from as i64)),
            to: differences(others.iter().map(|(_, to)| *to as i64)),
        }
    }
}

/// The sessions, where runs of nodes of one session begin, and the session of each run, counted from 1.
fn runs(graph: &PoseGraph) -> (Vec<String>, Vec<i64>, Vec<i64>) {
    let (mut names, mut starts, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut known: HashMap<&str, i64> = HashMap::new();
    for (index, node) in graph.nodes.iter().enumerate() {
        let number = node.session.as_deref().map_or(0, |name| {
            *known.entry(name).or_insert_with(|| {
                names.push(shortened(name));
                names.len() as i64
            })
        });
        if numbers.last() != Some(&number) {
            starts.push(index as i64);
            numbers.push(number);
        }
    }
    (names, starts, numbers)
}

/// For each node whether odometry in use joins it to the node before, and the ends of all other odometry in use.
fn odometry(graph: &PoseGraph) -> (Vec<bool>, Vec<(usize, usize)>) {
    let mut joined = vec![false; graph.nodes.len()];
    let mut others = Vec::new();
    for edge in graph.edges_of(EdgeKind::Odometry).filter(|edge| edge.in_use()) {
        let Some((from, to)) = graph.ends(edge) else { continue };
        if from.abs_diff(to) == 1 {
            joined[from.max(to)] = true;
        } else {
            others.push((from, to));
        }
    }
    (joined, others)
}

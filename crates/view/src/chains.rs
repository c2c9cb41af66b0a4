//! The names of the chains that verification calibrates.

use posecut_doctor::chains::in_order;
use posecut_graph::PoseGraph;

use crate::columns::shortened;

/// The names of `count` chains of odometry, without the edges that are `broken`. A chain is named by its sessions, or by its nodes
/// if another chain has the same. If the graph has another number of chains, they are numbered.
pub(crate) fn chains(graph: &PoseGraph, broken: impl Fn(u64) -> bool, count: usize) -> Vec<String> {
    let broken: Vec<usize> = (0..graph.edges.len()).filter(|&index| broken(graph.edges[index].id)).collect();
    let found = in_order(graph, &broken);
    if found.len() != count {
        return (1..=count).map(|number| format!("chain {number}")).collect();
    }
    let sessions: Vec<String> = found.iter().map(|chain| sessions(graph, chain)).collect();
    let mut sorted: Vec<&String> = sessions.iter().collect();
    sorted.sort();
    let unique =
        sorted.windows(2).all(|pair| pair[0] != pair[1]) && sorted.iter().all(|name| !name.is_empty());
    found
        .iter()
        .zip(&sessions)
        .map(|(chain, session)| {
            let id = |index: Option<&usize>| index.map_or(0, |&index| graph.nodes[index].id);
            let (first, last) = (id(chain.first()), id(chain.last()));
            let nodes =
                if first == last { format!("node {first}") } else { format!("nodes {first} to {last}") };
            match (unique, session.is_empty()) {
                (true, _) => session.clone(),
                (false, true) => nodes,
                (false, false) => format!("{session}, {nodes}"),
            }
        })
        .collect()
}

/// The sessions of these nodes: one, or the first and how many others.
fn sessions(graph: &PoseGraph, nodes: &[usize]) -> String {
    let mut names: Vec<&str> =
        nodes.iter().filter_map(|&node| graph.nodes[node].session.as_deref()).collect();
    names.dedup();
    names.sort_unstable();
    names.dedup();
    match names.as_slice() {
        [] => String::new(),
        [only] => shortened(only),
        [first, others @ ..] => format!("{} and {} more", shortened(first), others.len()),
    }
}

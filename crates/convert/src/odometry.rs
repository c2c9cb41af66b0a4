//! Decides which edges are odometry, in formats that do not say it.

use std::borrow::Borrow;
use std::collections::{BTreeMap, BTreeSet, HashSet};

use posecut_graph::{Edge, EdgeKind};
use serde::Serialize;

/// Which edges of a file without kinds of edges are odometry. All others are landmark edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Odometry {
    /// As consecutive; for robots without any such edge, as next-id if that finds at least every second one
    #[default]
    Auto,
    /// The first edge between ids n and n + 1
    Consecutive,
    /// The first edge between an id and the next larger id of the same robot
    NextId,
    /// No edge
    None,
}

/// The odometry of one robot that was found by the next id because no two ids are consecutive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NextIds {
    /// The number of odometry edges.
    pub edges: usize,
    /// The ends of the first of them.
    pub first: (u64, u64),
}

/// The robot of an id: the letter in its top byte, as in gtsam's symbols; `None` if there is none.
pub(crate) fn robot(id: u64) -> Option<char> {
    let letter = (id >> 56) as u8;
    letter.is_ascii_alphabetic().then(|| char::from(letter))
}

/// The number of an id below its top byte: the frame of a robot's pose.
pub(crate) fn frame(id: u64) -> u64 {
    id & ((1 << 56) - 1)
}

/// Session and frame of an id: those of its robot, or this session with the id as frame.
pub(crate) fn session_and_frame(id: u64, session: &str) -> (String, i64) {
    match robot(id) {
        Some(letter) => (letter.to_string(), frame(id) as i64),
        None => (session.to_owned(), i64::try_from(id).unwrap_or(i64::MAX)),
    }
}

/// The kind of an edge by the ids of its vertices: the first edge between a vertex and its successor is odometry.
pub(crate) fn consecutive(successive: &mut HashSet<u64>, from: u64, to: u64) -> EdgeKind {
    let odometry = from.abs_diff(to) == 1 && successive.insert(from.min(to));
    if odometry { EdgeKind::Odometry } else { EdgeKind::Landmark }
}

/// Sets the kinds of the edges, except those whose kind the file states. `ids` are all ids of the file. Returns what `Auto` found
/// by the next id. O((ids + edges) log ids).
pub(crate) fn set_kinds(
    rule: Odometry,
    ids: &BTreeSet<u64>,
    edges: &mut [Edge],
    stated: &[bool],
) -> Vec<NextIds> {
    let mut successive = HashSet::new();
    let next = if rule == Odometry::NextId { next_ids(ids.iter().copied()) } else { BTreeMap::new() };
    for (edge, _) in edges.iter_mut().zip(stated).filter(|(_, stated)| !**stated) {
        edge.kind = match rule {
            Odometry::Auto | Odometry::Consecutive => consecutive(&mut successive, edge.from, edge.to),
            Odometry::NextId => by_next_id(&next, &mut successive, edge),
            Odometry::None => EdgeKind::Landmark,
        };
    }
    if rule != Odometry::Auto {
        return Vec::new();
    }
    let found = find_missing(&ids.iter().copied(), edges, stated);
    let set = |missing: Vec<usize>| {
        for &index in &missing {
            edges[index].kind = EdgeKind::Odometry;
        }
        NextIds { edges: missing.len(), first: (edges[missing[0]].from, edges[missing[0]].to) }
    };
    found.into_iter().map(set).collect()
}

/// The id after each id, if both belong to one robot. The ids ascend.
fn next_ids(ids: impl Iterator<Item = u64> + Clone) -> BTreeMap<u64, u64> {
    ids.clone().zip(ids.skip(1)).filter(|&(id, next)| robot(id) == robot(next)).collect()
}

fn by_next_id(next: &BTreeMap<u64, u64>, seen: &mut HashSet<u64>, edge: &Edge) -> EdgeKind {
    let (low, high) = (edge.from.min(edge.to), edge.from.max(edge.to));
    let odometry = next.get(&low) == Some(&high) && seen.insert(low);
    if odometry { EdgeKind::Odometry } else { EdgeKind::Landmark }
}

/// The edges between neighbouring ids, for each robot without odometry and without stated kinds, if they join at least half of the
/// neighbours. Fewer are more likely landmark edges of a file without odometry. `ids` may repeat and come in any order.
pub(crate) fn find_missing(
    ids: &(impl Iterator<Item = u64> + Clone),
    edges: &[impl Borrow<Edge>],
    stated: &[bool],
) -> Vec<Vec<usize>> {
    let mut settled = BTreeSet::new();
    for (edge, stated) in edges.iter().map(Borrow::borrow).zip(stated) {
        if *stated || edge.kind == EdgeKind::Odometry {
            settled.extend([robot(edge.from), robot(edge.to)]);
        }
    }
    let open: BTreeSet<Option<char>> =
        ids.clone().map(robot).filter(|name| !settled.contains(name)).collect();
    let of_robot = |name: Option<char>| {
        let ids: BTreeSet<u64> = ids.clone().filter(|&id| robot(id) == name).collect();
        let next = next_ids(ids.iter().copied());
        let mut seen = HashSet::new();
        let odometry: Vec<usize> = (0..edges.len())
            .filter(|&index| by_next_id(&next, &mut seen, edges[index].borrow()) == EdgeKind::Odometry)
            .collect();
        (!odometry.is_empty() && 2 * odometry.len() >= next.len()).then_some(odometry)
    };
    open.into_iter().filter_map(of_robot).collect()
}

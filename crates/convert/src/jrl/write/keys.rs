//! The keys of nodes: a robot's letter and a number.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use posecut_graph::PoseGraph;

use crate::ConvertError;
use crate::jrl::{LAST_POSE, STAMP};
use crate::odometry::{frame, robot};

/// The key of a node, and its place in the dataset.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub(super) letter: char,
    number: u64,
    /// The index of its entry in the list of its robot.
    pub(super) entry: usize,
}

impl Key {
    pub(super) fn key(&self) -> u64 {
        (u64::from(u32::from(self.letter)) << 56) | self.number
    }
}

/// The keys of all nodes.
pub(super) struct Keys {
    /// By the index of the node.
    pub(super) nodes: Vec<Key>,
    /// The indices of the nodes in the order of their keys.
    pub(super) order: Vec<usize>,
    /// The robots.
    pub(super) letters: Vec<char>,
    /// The robots whose letter is not the name of their session.
    pub(super) renamed: Vec<(char, String)>,
}

impl Keys {
    /// Keeps ids that are keys already. Otherwise each session gets a letter, its own name if that is one, and its nodes their frames
    /// or, if these repeat, numbers from 0.
    pub(super) fn of(graph: &PoseGraph) -> Result<Self, ConvertError> {
        let mut renamed = Vec::new();
        let are_keys = graph.nodes.iter().all(|node| robot(node.id).is_some() && frame(node.id) <= LAST_POSE);
        let mut nodes: Vec<Key> = if are_keys {
            let key = |id| Key { letter: robot(id).unwrap_or('a'), number: frame(id), entry: 0 };
            graph.nodes.iter().map(|node| key(node.id)).collect()
        } else {
            let letters = letters(graph)?;
            renamed.extend(
                letters
                    .iter()
                    .filter(|(name, letter)| **name != letter.to_string())
                    .map(|(name, letter)| (*letter, (*name).to_owned())),
            );
            renamed.sort_unstable();
            numbered(graph, &letters)
        };
        let mut order: Vec<usize> = (0..nodes.len()).collect();
        order.sort_by_key(|&index| nodes[index].key());
        let mut counts: BTreeMap<char, usize> = BTreeMap::new();
        for &index in &order {
            let count = counts.entry(nodes[index].letter).or_default();
            nodes[index].entry = *count;
            *count += 1;
        }
        Ok(Self { nodes, order, letters: counts.into_keys().collect(), renamed })
    }
}

/// A letter for each session.
fn letters(graph: &PoseGraph) -> Result<BTreeMap<&str, char>, ConvertError> {
    let sessions: BTreeSet<&str> =
        graph.nodes.iter().map(|node| node.session.as_deref().unwrap_or_default()).collect();
    let own = |name: &str| {
        let mut characters = name.chars();
        characters.next().filter(|letter| letter.is_ascii_alphabetic() && characters.next().is_none())
    };
    let taken: BTreeSet<char> = sessions.iter().filter_map(|name| own(name)).collect();
    let mut free = ('a'..='z').chain('A'..='Z').filter(|letter| !taken.contains(letter));
    sessions
        .iter()
        .map(|name| {
            let letter = own(name).or_else(|| free.next()).ok_or_else(|| {
                ConvertError::graph(
                    format!("the graph has {} sessions", sessions.len()),
                    "a JRL dataset has at most 52 robots, one for each letter; extract some sessions with posecut-inspect filter",
                )
            })?;
            Ok((*name, letter))
        })
        .collect()
}

fn numbered(graph: &PoseGraph, letters: &BTreeMap<&str, char>) -> Vec<Key> {
    let session = |index: usize| graph.nodes[index].session.as_deref().unwrap_or_default();
    let own = |index: usize| {
        graph.nodes[index]
            .frame
            .and_then(|frame| u64::try_from(frame).ok())
            .filter(|number| *number <= LAST_POSE)
    };
    // Sessions whose frames cannot be the numbers of keys.
    let mut seen = HashSet::new();
    let unusable: HashSet<&str> = (0..graph.nodes.len())
        .filter(|&index| own(index).is_none_or(|number| !seen.insert((session(index), number))))
        .map(session)
        .collect();
    let mut counts: BTreeMap<&str, u64> = BTreeMap::new();
    (0..graph.nodes.len())
        .map(|index| {
            let name = session(index);
            let count = counts.entry(name).or_default();
            let number = own(index).filter(|_| !unusable.contains(name)).unwrap_or(*count);
            *count += 1;
            Key { letter: letters.get(name).copied().unwrap_or('a'), number, entry: 0 }
        })
        .collect()
}

/// The stamp of each node: its own, else its time in microseconds, else the number of its key, one of these for all nodes.
pub(super) fn stamps(graph: &PoseGraph, keys: &Keys) -> Vec<u64> {
    let stamps = || graph.nodes.iter().map(|node| node.extra.get(STAMP)?.as_u64());
    let times = || graph.nodes.iter().map(|node| u64::try_from(node.utime?).ok());
    stamps()
        .collect::<Option<Vec<u64>>>()
        .or_else(|| times().collect())
        .unwrap_or_else(|| keys.nodes.iter().map(|key| key.number).collect())
}

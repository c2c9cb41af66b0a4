//! The components of a map: what edges in use join.

use std::collections::BTreeMap;

use posecut_graph::PoseGraph;
use serde::Serialize;

use crate::encode::differences;

/// Most components that a page names; smaller ones are one entry.
const MOST: usize = 30;

/// The components of a map, the largest first.
#[derive(Debug, Serialize)]
pub(crate) struct Parts {
    /// How many there are.
    count: usize,
    /// Nodes of each of the largest, and of all others together.
    sizes: Vec<usize>,
    /// For each node the index in `sizes`; absent if there is one component.
    index: Option<String>,
}

impl Parts {
    /// The components that edges in use with a measurement join, by the nodes of `graph`. `map` has the marks.
    pub(crate) fn of(graph: &PoseGraph, map: &PoseGraph) -> Self {
        let first = map.first_of_part(|edge| edge.measurement.is_some());
        let first: Vec<Option<usize>> =
            graph.nodes.iter().map(|node| map.node_index(node.id).map(|index| first[index])).collect();
        let mut sizes: BTreeMap<usize, usize> = BTreeMap::new();
        for part in first.iter().flatten() {
            *sizes.entry(*part).or_default() += 1;
        }
        let mut ranked: Vec<(usize, usize)> = sizes.into_iter().collect();
        ranked.sort_by_key(|(part, size)| (std::cmp::Reverse(*size), *part));
        let rank: BTreeMap<usize, usize> =
            ranked.iter().enumerate().map(|(rank, (part, _))| (*part, rank.min(MOST))).collect();
        let mut sizes: Vec<usize> = ranked.iter().take(MOST).map(|(_, size)| *size).collect();
        if ranked.len() > MOST {
            sizes.push(ranked[MOST..].iter().map(|(_, size)| size).sum());
        }
        let index = (ranked.len() > 1).then(|| {
            let of =
                |part: &Option<usize>| part.and_then(|part| rank.get(&part)).map_or(-1, |rank| *rank as i64);
            differences(first.iter().map(of))
        });
        Self { count: ranked.len(), sizes, index }
    }
}

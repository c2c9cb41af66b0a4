//! Labels as a list of the correct pairs.

use anyhow::{Context as _, bail};
use posecut_graph::PoseGraph;

use crate::{by_ends, landmarks, set};

/// A correct pair of nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pair {
    /// Line of the file, from 1.
    pub line: usize,
    /// The two nodes, in either order.
    pub ends: (u64, u64),
}

/// Reads a list with two node ids a line, between spaces or commas. Lines that start with `#` are comments; a list may
/// be empty.
pub fn read(file: &str, bytes: &[u8]) -> anyhow::Result<Vec<Pair>> {
    let text = std::str::from_utf8(bytes)
        .with_context(|| format!("{file}: is not a text file; name a list with two node ids per line"))?;
    let mut pairs = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let fields: Vec<&str> =
            line.split([' ', '\t', ',', '\r']).filter(|field| !field.is_empty()).collect();
        if fields.first().is_none_or(|first| first.starts_with('#')) {
            continue;
        }
        let ids: Option<Vec<u64>> = fields.iter().map(|field| field.parse().ok()).collect();
        let Some([first, second]) = ids.as_deref() else {
            bail!(
                "{file}, line {}: expected two node ids, found \"{}\"; correct the line",
                index + 1,
                line.trim()
            );
        };
        pairs.push(Pair { line: index + 1, ends: (*first, *second) });
    }
    Ok(pairs)
}

/// Labels the edges between listed pairs correct and all others incorrect. Refuses a pair without an edge.
pub fn apply(graph: &mut PoseGraph, file: &str, pairs: &[Pair]) -> anyhow::Result<()> {
    let positions = by_ends(graph);
    landmarks(graph).for_each(|edge| set(edge, false));
    for &Pair { line, ends: (first, second) } in pairs {
        let found: Vec<usize> = [(first, second), (second, first)]
            .iter()
            .flat_map(|ends| positions.get(ends).into_iter().flatten().copied())
            .collect();
        if found.is_empty() {
            bail!(
                "{file}, line {line}: calls {first} {second} correct, but the graph has no landmark edge between them; use the list of this graph"
            );
        }
        for position in found {
            set(&mut graph.edges[position], true);
        }
    }
    Ok(())
}

//! Labels as a table: CSV with the columns `i`, `j` and `inlier`.

use std::collections::{HashMap, VecDeque};

use anyhow::{Context as _, bail};
use posecut_graph::{EdgeKind, PoseGraph};

use crate::{described, set};

/// One row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// Line of the file, from 1.
    pub line: u64,
    /// The nodes that the edge joins.
    pub ends: (u64, u64),
    /// Whether the edge is correct.
    pub correct: bool,
}

/// Reads a table of labels. Columns are found by name; other columns are ignored. If there is a column `kind`, only rows
/// `loop` are landmark edges.
pub fn read(file: &str, bytes: &[u8]) -> anyhow::Result<Vec<Row>> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).flexible(true).from_reader(bytes);
    let header = reader
        .headers()
        .with_context(|| format!("{file}, line 1: cannot be read; save the labels as CSV in UTF-8"))?
        .clone();
    let find = |name: &str| header.iter().position(|column| column.eq_ignore_ascii_case(name));
    let needed = |name: &str| {
        find(name).with_context(|| {
            format!("{file}, line 1: the header has no column \"{name}\"; name the columns i,j,inlier")
        })
    };
    let (i, j, inlier, kind) = (needed("i")?, needed("j")?, needed("inlier")?, find("kind"));
    let mut rows = Vec::new();
    for record in reader.records() {
        let record =
            record.with_context(|| format!("{file}: cannot be read; save the labels as CSV in UTF-8"))?;
        let line = record.position().map_or(0, csv::Position::line);
        let field = |column: usize| record.get(column).unwrap_or_default();
        if kind.is_some_and(|kind| field(kind) != "loop") {
            continue;
        }
        let node = |column: usize, name: &str| {
            field(column).parse::<u64>().with_context(|| {
                format!(
                    "{file}, line {line}: {name} is \"{}\", but must be the id of a node; correct the line",
                    field(column)
                )
            })
        };
        let correct = match field(inlier) {
            "1" | "true" => true,
            "0" | "false" => false,
            other => {
                bail!("{file}, line {line}: inlier is \"{other}\", but must be 1 or 0; correct the line")
            }
        };
        rows.push(Row { line, ends: (node(i, "i")?, node(j, "j")?), correct });
    }
    Ok(rows)
}

/// Sets the labels. Several edges between the same nodes get their rows in the order of both files. A row also matches an
/// edge in the other direction. Refuses rows without an edge and edges without a row.
pub fn apply(graph: &mut PoseGraph, file: &str, rows: &[Row]) -> anyhow::Result<()> {
    let mut labels: HashMap<(u64, u64), VecDeque<&Row>> = HashMap::new();
    for row in rows {
        labels.entry(row.ends).or_default().push_back(row);
    }
    let mut take = |ends: (u64, u64)| labels.get_mut(&ends).and_then(VecDeque::pop_front);
    // First serve edges that have a row in their own direction; otherwise an edge in the other direction could take that row.
    let mut others = Vec::new();
    for (position, edge) in graph.edges.iter_mut().enumerate() {
        if edge.kind == EdgeKind::Landmark {
            match take((edge.from, edge.to)) {
                Some(row) => set(edge, row.correct),
                None => others.push(position),
            }
        }
    }
    for position in others {
        let edge = &mut graph.edges[position];
        match take((edge.to, edge.from)) {
            Some(row) => set(edge, row.correct),
            None => bail!(
                "{file}: has no label for {}; add a line, or use the labels of this graph",
                described(edge)
            ),
        }
    }
    if let Some(row) = labels.values().flatten().min_by_key(|row| row.line) {
        bail!(
            "{file}, line {}: labels an edge {} {}, but the graph has no such landmark edge; use the labels of this graph",
            row.line,
            row.ends.0,
            row.ends.1
        );
    }
    Ok(())
}

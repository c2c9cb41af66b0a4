//! What each stage did to a graph, from its provenance.

use posecut_graph::{Header, doubts_of};
use serde::Serialize;
use serde_json::Value;

use crate::arguments::said;
use crate::columns::shortened;

/// Most stages that a page lists; of a longer history, the last ones.
const MOST: usize = 200;

/// One stage.
#[derive(Debug, Serialize)]
pub(crate) struct Stage {
    name: String,
    version: String,
    /// Arguments, seed, and doubts.
    arguments: String,
    doubts: String,
    /// The files that it read: role and digest.
    inputs: Vec<(String, String)>,
}

/// The stages of a graph, oldest first.
pub(crate) fn stages(header: &Header) -> Vec<Stage> {
    let left_out = header.provenance.len().saturating_sub(MOST);
    header.provenance[left_out..].iter().map(stage).collect()
}

fn stage(entry: &Value) -> Stage {
    let field = |value: &Value, name: &str| {
        value.get(name).and_then(Value::as_str).map_or_else(|| "?".to_owned(), shortened)
    };
    let mut arguments = entry.get("arguments").map_or_else(|| shortened(&entry.to_string()), said);
    if let Some(seed) = entry.get("seed").and_then(Value::as_u64) {
        let comma = if arguments.is_empty() { "" } else { ", " };
        arguments += &format!("{comma}seed = {seed}");
    }
    let inputs = entry.get("inputs").and_then(Value::as_array);
    let doubts: Vec<&str> = doubts_of(entry).collect();
    Stage {
        name: field(entry, "stage"),
        version: field(entry, "version"),
        arguments,
        doubts: doubts.join(", "),
        inputs: inputs
            .into_iter()
            .flatten()
            .map(|input| (field(input, "name"), field(input, "sha256")))
            .collect(),
    }
}

/// Whether an optimiser made the poses of a graph.
pub(crate) fn optimised(header: &Header) -> bool {
    let stage = |entry: &Value| entry.get("stage").and_then(Value::as_str).map(str::to_owned);
    header
        .provenance
        .iter()
        .filter_map(stage)
        .any(|stage| ["optimize", "isam", "clean"].contains(&stage.as_str()))
}

//! The order in which the records of a file are replayed.
//!
//! A *stream* has its records in the order of time: a pose, then the edges that end at it, and so on. A file in canonical
//! form has all nodes first. It is replayed as a session: nodes by id, each followed by the edges whose later end it is.

use std::collections::HashMap;
use std::io::BufRead;

use anyhow::Context as _;
use posecut_graph::{PoseGraph, Record, RecordReader};
use serde::Deserialize;

use super::session::Arrival;

/// A record of the session, and its line.
#[derive(Clone, Debug)]
pub(super) struct Located {
    pub(super) line: u64,
    pub(super) arrival: Arrival,
}

/// A record of a kind that only the incremental mode knows. Its edge is read once the kind is known.
#[derive(Deserialize)]
struct Decision {
    kind: String,
    #[serde(default)]
    edge: serde_json::Value,
}

/// Reads records and passes them on in the order of time; the kinds of unknown records go to `unknown`.
///
/// Whether a file is a stream is unknown until a node follows an edge; the records up to there are kept back.
pub(super) fn for_each<R: BufRead>(
    source: &str,
    reader: RecordReader<R>,
    unknown: &mut Vec<String>,
    mut take: impl FnMut(Located) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let mut reader = reader;
    let mut held: Option<Vec<Located>> = Some(Vec::new());
    let mut edges_began = false;
    while let Some(record) = reader.next().transpose()? {
        let line = reader.line();
        let Some(arrival) = arrival(record, unknown).with_context(|| format!("{source}, line {line}"))?
        else {
            continue;
        };
        let is_node = matches!(arrival, Arrival::Node(_));
        let located = Located { line, arrival };
        if is_node && edges_began {
            for earlier in held.take().into_iter().flatten() {
                take(earlier)?;
            }
        }
        edges_began |= !is_node;
        match &mut held {
            Some(held) => held.push(located),
            None => take(located)?,
        }
    }
    canonical(held.unwrap_or_default()).into_iter().try_for_each(take)
}

fn arrival(record: Record, unknown: &mut Vec<String>) -> anyhow::Result<Option<Arrival>> {
    Ok(match record {
        Record::Header(_) => None,
        Record::Node(node) => Some(Arrival::Node(node)),
        Record::Edge(edge) => Some(Arrival::Edge(edge)),
        Record::Prior(prior) => anyhow::bail!(
            "{}: the incremental solver does not use priors; optimise the graph with posecut-optimize, or remove the prior",
            prior.name()
        ),
        Record::Unknown(text) => {
            let Decision { kind, edge } = serde_json::from_str(&text)?;
            let edge = || {
                edge.as_u64().with_context(|| {
                    format!("{kind}, field \"edge\": expected the id of an earlier edge, found {edge}; give a whole number")
                })
            };
            match kind.as_str() {
                "retract" => Some(Arrival::Retract(edge()?)),
                "readmit" => Some(Arrival::Readmit(edge()?)),
                _ => {
                    unknown.push(text);
                    None
                }
            }
        }
    })
}

/// Sorts nodes by id, each followed by the edges whose later end it is, by id; decisions come last. An edge to a missing pose
/// comes at the end, where it is refused.
fn canonical(mut records: Vec<Located>) -> Vec<Located> {
    let key = |located: &Located| match &located.arrival {
        Arrival::Node(node) => node.id,
        Arrival::Edge(edge) => edge.id,
        Arrival::Retract(_) | Arrival::Readmit(_) => 0,
    };
    let rank = |located: &Located| match &located.arrival {
        Arrival::Node(_) => 0,
        Arrival::Edge(_) => 1,
        Arrival::Retract(_) | Arrival::Readmit(_) => 2,
    };
    records.sort_by_key(|located| (rank(located), key(located)));
    let mut places = HashMap::new();
    for located in &records {
        if let Arrival::Node(node) = &located.arrival {
            let place = places.len();
            places.entry(node.id).or_insert(place);
        }
    }
    let step = |located: &Located| match &located.arrival {
        Arrival::Node(node) => places[&node.id],
        Arrival::Edge(edge) => {
            let place = |id: u64| places.get(&id).copied().unwrap_or(usize::MAX);
            place(edge.from).max(place(edge.to))
        }
        Arrival::Retract(_) | Arrival::Readmit(_) => usize::MAX,
    };
    records.sort_by_key(|located| (step(located), rank(located)));
    records
}

/// A graph with this header only.
pub(super) fn empty<R: BufRead>(reader: &RecordReader<R>) -> PoseGraph {
    PoseGraph::new(reader.header().clone())
}

//! What changed between two pose graphs.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use posecut_geometry::{LieGroup, SE2, SE3};
use posecut_graph::{Dimension, PoseGraph, WriteError};
use posecut_stage::counted;
use serde::Serialize;
use serde_json::{Map, Value};

use crate::info::provenance_line;

/// The most ids that the text lists for each change; the JSON has all.
const LISTED: usize = 10;

/// The differences, as in `--stats`. Records are matched by kind and id.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Difference {
    /// Whether the graphs are the same except for the history.
    pub same: bool,
    /// Header fields that differ, except the history.
    pub header: Vec<String>,
    /// Entries that only the second graph's history has, after the common beginning.
    pub provenance_added: Vec<String>,
    /// Entries that only the first graph's history has, after the common beginning.
    pub provenance_removed: Vec<String>,
    /// Changes of nodes.
    pub nodes: Changes,
    /// Nodes whose estimates differ.
    pub moved: Vec<Moved>,
    /// Changes of edges of both kinds.
    pub edges: Changes,
    /// Changes of priors; absent if there are none.
    #[serde(skip_serializing_if = "Changes::is_none")]
    pub priors: Changes,
    /// Edges that are marked only in the second graph, by stage.
    pub marked: BTreeMap<String, Vec<u64>>,
    /// Edges that are marked only in the first graph, by stage.
    pub unmarked: BTreeMap<String, Vec<u64>>,
    /// Edges that another stage marked in the second graph.
    pub marked_anew: Vec<u64>,
    /// Records of other kinds that only the first graph has.
    pub unknown_removed: usize,
    /// Records of other kinds that only the second graph has.
    pub unknown_added: usize,
}

/// Records and fields that were added, removed or changed.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Changes {
    /// Ids that only the second graph has.
    pub added: Vec<u64>,
    /// Ids that only the first graph has.
    pub removed: Vec<u64>,
    /// Ids of records that differ.
    pub changed: Vec<u64>,
    /// For each field, the number of records that differ in it.
    pub fields: BTreeMap<String, FieldChanges>,
}

impl Changes {
    /// Whether nothing changed.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// Records in which a field differs.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct FieldChanges {
    /// Number of records that have the field only in the second graph.
    pub added: usize,
    /// Number of records that have the field only in the first graph.
    pub removed: usize,
    /// Number of records that have it in both, with different values.
    pub changed: usize,
}

/// How far an estimate moved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moved {
    /// The node.
    pub id: u64,
    /// Metres.
    pub translation: f64,
    /// Radians, from 0 to pi.
    pub rotation: f64,
}

impl Difference {
    /// Compares two graphs field by field. Numbers that differ by at most `tolerance` are the same. O(size log size).
    pub fn between(first: &PoseGraph, second: &PoseGraph, tolerance: f64) -> Result<Self, WriteError> {
        let (before, after) = (Records::of(first)?, Records::of(second)?);
        let mut difference = Self {
            header: changed_fields(&before.header, &after.header, tolerance)
                .map(|(name, _)| name.to_owned())
                .collect(),
            nodes: changes(&before.nodes, &after.nodes, tolerance),
            edges: changes(&before.edges, &after.edges, tolerance),
            priors: changes(&before.priors, &after.priors, tolerance),
            ..Self::default()
        };
        difference.history(first, second);
        difference.movements(first, second, tolerance);
        difference.marks(&before.edges, &after.edges);
        difference.unknown_removed = only_in(&first.unknown, &second.unknown);
        difference.unknown_added = only_in(&second.unknown, &first.unknown);
        difference.same = difference.header.is_empty()
            && difference.nodes.is_none()
            && difference.edges.is_none()
            && difference.priors.is_none()
            && difference.unknown_removed + difference.unknown_added == 0;
        Ok(difference)
    }

    fn history(&mut self, first: &PoseGraph, second: &PoseGraph) {
        let (before, after) = (&first.header.provenance, &second.header.provenance);
        let common = before.iter().zip(after).take_while(|(a, b)| a == b).count();
        self.provenance_removed = before[common..].iter().map(provenance_line).collect();
        self.provenance_added = after[common..].iter().map(provenance_line).collect();
    }

    fn movements(&mut self, first: &PoseGraph, second: &PoseGraph, tolerance: f64) {
        if first.header.dimension != second.header.dimension {
            return;
        }
        for node in &first.nodes {
            let other = second.node_index(node.id).map(|index| &second.nodes[index]);
            let (Some(before), Some(after)) = (&node.pose, other.and_then(|other| other.pose.as_ref()))
            else {
                continue;
            };
            let far = before.iter().zip(after).any(|(a, b)| (a - b).abs() > tolerance);
            if let Some((translation, rotation)) =
                movement(first.header.dimension, before, after).filter(|_| far)
            {
                self.moved.push(Moved { id: node.id, translation, rotation });
            }
        }
    }

    fn marks(&mut self, before: &ById, after: &ById) {
        let stage = |record: &Map<String, Value>| {
            record.get("rejected_by").and_then(Value::as_str).map(str::to_owned)
        };
        for (id, record) in before {
            let Some(other) = after.get(id) else { continue };
            match (stage(record), stage(other)) {
                (None, Some(stage)) => self.marked.entry(stage).or_default().push(*id),
                (Some(stage), None) => self.unmarked.entry(stage).or_default().push(*id),
                (Some(one), Some(another)) if one != another => self.marked_anew.push(*id),
                _ => {}
            }
        }
    }
}

fn movement(dimension: Dimension, before: &[f64], after: &[f64]) -> Option<(f64, f64)> {
    Some(match dimension {
        Dimension::Two => {
            let motion = SE2::from_components(before)?.between(&SE2::from_components(after)?);
            (motion.translation.norm(), motion.angle().abs())
        }
        Dimension::Three => {
            let motion = SE3::from_components(before)?.between(&SE3::from_components(after)?);
            (motion.translation.norm(), motion.rotation.angle())
        }
    })
}

type ById = BTreeMap<u64, Map<String, Value>>;

/// The records of a graph as JSON, so that known and unknown fields are compared alike.
struct Records {
    header: Map<String, Value>,
    nodes: ById,
    edges: ById,
    priors: ById,
}

impl Records {
    fn of(graph: &PoseGraph) -> Result<Self, WriteError> {
        let mut bytes = Vec::new();
        graph.write(&mut bytes)?;
        let mut records =
            Self { header: Map::new(), nodes: ById::new(), edges: ById::new(), priors: ById::new() };
        let known = 1 + graph.nodes.len() + graph.edges.len() + graph.priors.len();
        for (place, line) in bytes.split(|&byte| byte == b'\n').take(known).enumerate() {
            let record: Map<String, Value> =
                serde_json::from_slice(line).map_err(|error| WriteError::Io(error.into()))?;
            let id = record.get("id").and_then(Value::as_u64).unwrap_or_default();
            if place == 0 {
                records.header = record;
                records.header.remove("provenance");
            } else if place <= graph.nodes.len() {
                records.nodes.insert(id, record);
            } else if place <= graph.nodes.len() + graph.edges.len() {
                records.edges.insert(id, record);
            } else {
                records.priors.insert(id, record);
            }
        }
        Ok(records)
    }
}

fn changes(before: &ById, after: &ById, tolerance: f64) -> Changes {
    let mut changes = Changes::default();
    for (id, record) in before {
        let Some(other) = after.get(id) else {
            changes.removed.push(*id);
            continue;
        };
        let mut changed = false;
        for (name, side) in changed_fields(record, other, tolerance) {
            changed = true;
            let field = changes.fields.entry(name.to_owned()).or_default();
            match side {
                Side::First => field.removed += 1,
                Side::Second => field.added += 1,
                Side::Both => field.changed += 1,
            }
        }
        if changed {
            changes.changed.push(*id);
        }
    }
    changes.added = after.keys().filter(|id| !before.contains_key(id)).copied().collect();
    changes
}

/// The graph that has a field.
enum Side {
    First,
    Second,
    Both,
}

fn changed_fields<'a>(
    before: &'a Map<String, Value>,
    after: &'a Map<String, Value>,
    tolerance: f64,
) -> impl Iterator<Item = (&'a str, Side)> {
    let names: BTreeSet<&str> = before.keys().chain(after.keys()).map(String::as_str).collect();
    names.into_iter().filter_map(move |name| match (before.get(name), after.get(name)) {
        (Some(_), None) => Some((name, Side::First)),
        (None, Some(_)) => Some((name, Side::Second)),
        (Some(a), Some(b)) => (!same(a, b, tolerance)).then_some((name, Side::Both)),
        (None, None) => None,
    })
}

fn same(a: &Value, b: &Value, tolerance: f64) -> bool {
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => {
            x == y
                || matches!((x.as_f64(), y.as_f64()), (Some(x), Some(y)) if (x - y).abs() <= tolerance && (tolerance > 0.0 || !both_whole(a, b)))
        }
        (Value::Array(a), Value::Array(b)) => {
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| same(a, b, tolerance))
        }
        (Value::Object(a), Value::Object(b)) => {
            a.len() == b.len() && a.iter().all(|(name, a)| b.get(name).is_some_and(|b| same(a, b, tolerance)))
        }
        _ => a == b,
    }
}

/// Whether both are integers. They are not compared as doubles, because distinct ids above 2^53 may be equal as
/// doubles.
fn both_whole(a: &Value, b: &Value) -> bool {
    !a.is_f64() && !b.is_f64()
}

fn only_in(these: &[String], those: &[String]) -> usize {
    let mut left: BTreeMap<&str, usize> = BTreeMap::new();
    for line in those {
        *left.entry(line).or_default() += 1;
    }
    let missing = |line: &&String| match left.get_mut(line.as_str()).filter(|count| **count > 0) {
        Some(count) => {
            *count -= 1;
            false
        }
        None => true,
    };
    these.iter().filter(missing).count()
}

impl fmt::Display for Difference {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.same {
            writeln!(out, "the graphs are the same")?;
        }
        for field in &self.header {
            writeln!(out, "header      field {field} differs")?;
        }
        write_changes(out, "node", &self.nodes)?;
        if !self.moved.is_empty() {
            let farthest = self.moved.iter().max_by(|a, b| a.translation.total_cmp(&b.translation));
            let mean =
                self.moved.iter().map(|moved| moved.translation).sum::<f64>() / self.moved.len() as f64;
            let turned = self.moved.iter().map(|moved| moved.rotation).fold(0.0, f64::max);
            if let Some(farthest) = farthest {
                writeln!(
                    out,
                    "moved       {} by {mean:.3} m on average and {:.3} m at most (node {}), rotated by at most {turned:.4} rad",
                    counted(self.moved.len(), "node"),
                    farthest.translation,
                    farthest.id
                )?;
            }
        }
        write_changes(out, "edge", &self.edges)?;
        write_changes(out, "prior", &self.priors)?;
        for (stage, ids) in &self.marked {
            writeln!(out, "marked      {} by {stage}: {}", counted(ids.len(), "edge"), listed(ids))?;
        }
        for (stage, ids) in &self.unmarked {
            let edges = counted(ids.len(), "edge");
            writeln!(out, "unmarked    {edges} that {stage} had rejected: {}", listed(ids))?;
        }
        if !self.marked_anew.is_empty() {
            let edges = counted(self.marked_anew.len(), "edge");
            writeln!(out, "marked anew {edges}: {}", listed(&self.marked_anew))?;
        }
        if self.unknown_added + self.unknown_removed > 0 {
            writeln!(
                out,
                "unknown     {} added, {} removed",
                counted(self.unknown_added, "record"),
                self.unknown_removed
            )?;
        }
        for line in &self.provenance_removed {
            writeln!(out, "history     - {line}")?;
        }
        for line in &self.provenance_added {
            writeln!(out, "history     + {line}")?;
        }
        Ok(())
    }
}

fn write_changes(out: &mut fmt::Formatter<'_>, what: &str, changes: &Changes) -> fmt::Result {
    for (word, ids) in
        [("added", &changes.added), ("removed", &changes.removed), ("changed", &changes.changed)]
    {
        if !ids.is_empty() {
            writeln!(out, "{:11} {}: {}", word, counted(ids.len(), what), listed(ids))?;
        }
    }
    for (name, field) in &changes.fields {
        let counts =
            [("added to", field.added), ("removed from", field.removed), ("changed in", field.changed)];
        let counts: Vec<String> = counts
            .into_iter()
            .filter(|(_, count)| *count > 0)
            .map(|(word, count)| format!("{word} {}", counted(count, what)))
            .collect();
        writeln!(out, "field       {name} {}", counts.join(", "))?;
    }
    Ok(())
}

fn listed(ids: &[u64]) -> String {
    let mut text = ids.iter().take(LISTED).map(u64::to_string).collect::<Vec<_>>().join(" ");
    if ids.len() > LISTED {
        text.push_str(" …");
    }
    text
}

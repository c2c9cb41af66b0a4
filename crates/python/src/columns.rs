//! Fields of nodes and edges as columns: what each record has in one field, known or not.

use std::collections::BTreeSet;

use posecut_graph::{Edge, Extra, Node, PoseGraph};
use pyo3::prelude::*;
use pyo3::types::PyList;
use serde_json::Value;

use crate::arrays::row;
use crate::error::Error;

/// The largest integers that a float holds exactly.
const EXACT: u64 = 1 << 53;

/// Fields that are texts: always a list.
const TEXTS: [&str; 5] = ["kind", "session", "noise", "rejected_by", "truth.correct"];

/// Records of which kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Of {
    Nodes,
    Edges,
}

impl Of {
    /// `nodes` or `edges`.
    pub(crate) fn named(name: &str) -> PyResult<Self> {
        match name {
            "nodes" => Ok(Self::Nodes),
            "edges" => Ok(Self::Edges),
            _ => Err(Error::new_err(format!("there are no columns of {name:?}"))),
        }
    }
}

fn known(of: Of) -> &'static [&'static str] {
    match of {
        Of::Nodes => &["id", "session", "frame", "utime", "landmark"],
        Of::Edges => &["id", "kind", "from", "to", "noise", "truth.correct", "rejected_by", "cost", "score"],
    }
}

/// Fields that each graph has, even if no record of it has them.
fn always(of: Of) -> &'static [&'static str] {
    match of {
        Of::Nodes => &["id", "session", "frame"],
        Of::Edges => &["id", "kind", "from", "to", "rejected_by"],
    }
}

/// The names of the fields: those that each graph has, then others that a record has, in the order of the format.
pub(crate) fn names(graph: &PoseGraph, of: Of) -> Vec<String> {
    let has = |name: &str| {
        always(of).contains(&name)
            || match of {
                Of::Nodes => graph.nodes.iter().any(|node| !of_node(node, name).is_null()),
                Of::Edges => graph.edges.iter().any(|edge| !of_edge(edge, name).is_null()),
            }
    };
    let mut names: Vec<String> =
        known(of).iter().filter(|name| has(name)).map(|&name| name.to_owned()).collect();
    let mut seen = BTreeSet::new();
    let extras: Box<dyn Iterator<Item = &Extra>> = match of {
        Of::Nodes => Box::new(graph.nodes.iter().map(|node| &node.extra)),
        Of::Edges => Box::new(graph.edges.iter().map(|edge| &edge.extra)),
    };
    for name in extras.flat_map(Extra::keys) {
        if seen.insert(name) {
            names.push(name.clone());
        }
    }
    names
}

fn of_node(node: &Node, name: &str) -> Value {
    match name {
        "id" => node.id.into(),
        "session" => node.session.clone().into(),
        "frame" => node.frame.into(),
        "utime" => node.utime.into(),
        "landmark" => node.landmark.into(),
        _ => of_extra(&node.extra, node.truth.as_ref().map(|truth| &truth.extra), name),
    }
}

fn of_edge(edge: &Edge, name: &str) -> Value {
    match name {
        "id" => edge.id.into(),
        "kind" => edge.kind.name().into(),
        "from" => edge.from.into(),
        "to" => edge.to.into(),
        "noise" => edge.noise.clone().into(),
        "rejected_by" => edge.rejected_by.clone().into(),
        "cost" => edge.cost.into(),
        "score" => edge.score.into(),
        "truth.correct" => edge.truth_correct().into(),
        _ => of_extra(&edge.extra, edge.truth.as_ref().map(|truth| &truth.extra), name),
    }
}

fn of_extra(extra: &Extra, truth: Option<&Extra>, name: &str) -> Value {
    let within = || name.strip_prefix("truth.").and_then(|name| truth?.get(name));
    extra.get(name).or_else(within).cloned().unwrap_or(Value::Null)
}

/// A field of all records. Numbers and flags become an array, with NaN where a number is missing; everything else becomes a list,
/// with `None`. `None` if no record has the field.
pub(crate) fn column<'py>(
    py: Python<'py>,
    graph: &PoseGraph,
    of: Of,
    name: &str,
) -> PyResult<Option<Bound<'py, PyAny>>> {
    let values: Vec<Value> = match of {
        Of::Nodes => graph.nodes.iter().map(|node| of_node(node, name)).collect(),
        Of::Edges => graph.edges.iter().map(|edge| of_edge(edge, name)).collect(),
    };
    if values.iter().all(Value::is_null) && !known(of).contains(&name) {
        return Ok(None);
    }
    if TEXTS.contains(&name) {
        return listed(py, &values).map(Some);
    }
    if let Some(values) = all(&values, Value::as_bool) {
        return Ok(Some(row(py, values)));
    }
    let is_id = ["id", "from", "to"].contains(&name);
    if !is_id && let Some(values) = all(&values, Value::as_i64) {
        return Ok(Some(row(py, values)));
    }
    if let Some(values) = all(&values, Value::as_u64) {
        return Ok(Some(row(py, values)));
    }
    match all(&values, number) {
        Some(values) => Ok(Some(row(py, values))),
        None => listed(py, &values).map(Some),
    }
}

/// All values, if each is of one type.
fn all<T>(values: &[Value], of: impl Fn(&Value) -> Option<T>) -> Option<Vec<T>> {
    values.iter().map(of).collect()
}

/// A number without loss; NaN if there is none.
fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Null => Some(f64::NAN),
        Value::Number(number) if number.is_f64() => number.as_f64(),
        Value::Number(number) => {
            let size = number.as_u64().or_else(|| number.as_i64().map(i64::unsigned_abs))?;
            number.as_f64().filter(|_| size <= EXACT)
        }
        _ => None,
    }
}

fn listed<'py>(py: Python<'py>, values: &[Value]) -> PyResult<Bound<'py, PyAny>> {
    let simple: PyResult<Option<Vec<Bound<'py, PyAny>>>> =
        values.iter().map(|value| object(py, value)).collect();
    if let Some(objects) = simple? {
        return Ok(PyList::new(py, objects)?.into_any());
    }
    let text = serde_json::to_string(values).map_err(|error| Error::new_err(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// A value without parts as an object of Python; `None` for arrays and objects.
fn object<'py>(py: Python<'py>, value: &Value) -> PyResult<Option<Bound<'py, PyAny>>> {
    Ok(Some(match value {
        Value::Null => py.None().into_bound(py),
        Value::Bool(value) => value.into_pyobject(py)?.to_owned().into_any(),
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Number(number) => match (number.as_i64(), number.as_u64(), number.as_f64()) {
            (Some(value), _, _) => value.into_pyobject(py)?.into_any(),
            (_, Some(value), _) => value.into_pyobject(py)?.into_any(),
            (_, _, value) => value.into_pyobject(py)?.into_any(),
        },
        Value::Array(_) | Value::Object(_) => return Ok(None),
    }))
}

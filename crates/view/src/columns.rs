//! The fields that stages wrote on landmark edges, as columns of a table, whatever their names.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use posecut_graph::Edge;
use serde::Serialize;
use serde_json::Value;

use crate::encode::{Whole, differences};

/// Most columns of a page. A file may have a field of its own on every edge.
const MOST: usize = 24;

/// Longest list that is shown as text.
const LONGEST_LIST: usize = 6;

/// Longest text that is shown, characters.
const LONGEST_TEXT: usize = 200;

/// The field with the ids of the edges that decided about an edge. It is no column, because its edges are links.
const WITNESSES: &str = "verify_witness";

/// The column of labels; graphs have it only if somebody labelled edges.
pub(crate) const LABEL: &str = "label";

/// A value of every edge.
#[derive(Debug, Serialize)]
pub(crate) struct Column {
    name: String,
    #[serde(flatten)]
    values: Values,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "lowercase")]
enum Values {
    /// With six significant digits.
    Numbers(Vec<Option<f64>>),
    /// `index` counts from 1; 0 stands for a missing word.
    Words { words: Vec<String>, index: String },
}

/// The ids of witnesses of all edges, one after the other.
#[derive(Debug, Serialize)]
pub(crate) struct Witnesses {
    /// For each edge how many it has.
    count: String,
    id: Whole,
}

/// The names of the fields to show: the most frequent ones, in the order of their first edge. Also the number of fields that
/// cannot be shown, because they are lists or objects, or too many.
pub(crate) fn fields(edges: &[&Edge]) -> (Vec<String>, usize) {
    let mut found: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let mut hidden = BTreeSet::new();
    for edge in edges {
        let own = [("score", edge.score), ("cost", edge.cost)];
        let own = own.iter().filter(|(_, value)| value.is_some()).map(|(name, _)| *name);
        let others = edge.extra.iter().filter(|(name, value)| {
            if name.as_str() != WITNESSES && !value.is_null() && text(value).is_none() {
                hidden.insert(name.as_str());
            }
            text(value).is_some() && name.as_str() != WITNESSES && name.as_str() != LABEL
        });
        for name in own.chain(others.map(|(name, _)| name.as_str())) {
            let order = found.len();
            found.entry(name).or_insert((0, order)).0 += 1;
        }
    }
    let mut ranked: Vec<(&str, (usize, usize))> = found.into_iter().collect();
    ranked.sort_by_key(|(_, (count, order))| (std::cmp::Reverse(*count), *order));
    let dropped = ranked.len().saturating_sub(MOST);
    ranked.truncate(MOST);
    ranked.sort_by_key(|(_, (_, order))| *order);
    (ranked.into_iter().map(|(name, _)| name.to_owned()).collect(), hidden.len() + dropped)
}

/// The column of a field; `None` if no edge has it.
pub(crate) fn column(name: &str, edges: &[Option<&Edge>]) -> Option<Column> {
    let value = |edge: Option<&Edge>| {
        let edge = edge?;
        match name {
            "score" => edge.score.map(Value::from),
            "cost" => edge.cost.map(Value::from),
            _ => edge.extra.get(name).filter(|value| !value.is_null()).cloned(),
        }
    };
    let values: Vec<Option<Value>> = edges.iter().copied().map(value).collect();
    let mut present = values.iter().flatten().peekable();
    present.peek()?;
    let values = if present.all(Value::is_number) {
        Values::Numbers(values.iter().map(|value| value.as_ref()?.as_f64().map(significant)).collect())
    } else {
        words(values.iter().map(|value| value.as_ref().and_then(text)))
    };
    Some(Column { name: name.to_owned(), values })
}

/// The column of labels; `None` if no edge has one.
pub(crate) fn labels(edges: &[&Edge]) -> Option<Column> {
    let label = |edge: &&Edge| {
        edge.truth_correct().map(|correct| if correct { "correct" } else { "incorrect" }.to_owned())
    };
    let any = edges.iter().any(|edge| edge.truth_correct().is_some());
    any.then(|| Column { name: LABEL.to_owned(), values: words(edges.iter().map(label)) })
}

/// The witnesses of all edges; `None` if no edge has any.
pub(crate) fn witnesses(edges: &[Option<&Edge>]) -> Option<Witnesses> {
    let lists: Vec<Vec<u64>> = edges
        .iter()
        .map(|edge| {
            let list = edge.and_then(|edge| edge.extra.get(WITNESSES)).and_then(Value::as_array);
            list.into_iter().flatten().filter_map(Value::as_u64).take(LONGEST_LIST).collect()
        })
        .collect();
    lists.iter().any(|list| !list.is_empty()).then(|| Witnesses {
        count: differences(lists.iter().map(|list| list.len() as i64)),
        id: Whole::of(&lists.concat()),
    })
}

/// Words in the order of their first edge.
fn words(texts: impl Iterator<Item = Option<String>>) -> Values {
    let mut words: Vec<String> = Vec::new();
    let mut known: HashMap<String, i64> = HashMap::new();
    let index: Vec<i64> = texts
        .map(|text| {
            let Some(text) = text else { return 0 };
            *known.entry(text).or_insert_with_key(|text| {
                words.push(text.clone());
                words.len() as i64
            })
        })
        .collect();
    Values::Words { words, index: differences(index) }
}

/// A value as text; `None` for what a table has no room for.
fn text(value: &Value) -> Option<String> {
    match value {
        Value::Null | Value::Object(_) => None,
        Value::String(text) => Some(shortened(text)),
        Value::Bool(_) | Value::Number(_) => Some(value.to_string()),
        Value::Array(list) if list.len() > LONGEST_LIST => None,
        Value::Array(list) => {
            let all: Option<Vec<String>> =
                list.iter().map(|one| if one.is_array() { None } else { text(one) }).collect();
            all.map(|all| all.join(", ")).filter(|text| !text.is_empty())
        }
    }
}

/// A text that fits into a table.
pub(crate) fn shortened(text: &str) -> String {
    match text.char_indices().nth(LONGEST_TEXT) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

/// Six significant digits.
fn significant(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use posecut_graph::EdgeKind;
    use serde_json::json;

    use super::*;

    fn edge(id: u64, fields: &Value) -> Edge {
        let mut edge = Edge::new(EdgeKind::Landmark, id, 0, 1);
        edge.extra = fields.as_object().unwrap().clone();
        edge
    }

    #[test]
    fn the_most_frequent_fields_are_shown_in_their_order() {
        let edges: Vec<Edge> = (0..100)
            .map(|id| {
                edge(id, &json!({format!("own_{id}"): 1, "common": id, "matrix": vec![0; 21], "other": "a"}))
            })
            .collect();
        let edges: Vec<&Edge> = edges.iter().collect();
        let (names, hidden) = fields(&edges);
        assert_eq!(names.len(), MOST);
        assert!(names.contains(&"common".to_owned()) && names.contains(&"other".to_owned()));
        assert_eq!(hidden, 1 + 102 - MOST);
    }

    #[test]
    fn numbers_stay_numbers_and_everything_else_becomes_text() {
        let edges = [edge(0, &json!({"a": 1.234_567_8, "b": 1})), edge(1, &json!({"a": null, "b": "x"}))];
        let edges: Vec<Option<&Edge>> = edges.iter().map(Some).chain([None]).collect();
        let shown = |name| serde_json::to_value(column(name, &edges)).unwrap();
        assert_eq!(shown("a"), json!({"name": "a", "numbers": [1.23457, null, null]}));
        assert_eq!(
            shown("b"),
            json!({"name": "b", "words": {"words": ["1", "x"], "index": differences([1, 2, 0])}})
        );
        assert_eq!(shown("c"), Value::Null);
    }
}

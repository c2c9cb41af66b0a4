//! The summary of a run, for `--stats`.

use serde::Serialize;
use serde_json::{Map, Value};

/// Named figures in the order they were noted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics(Map<String, Value>);

impl Statistics {
    /// Notes a figure; a second note of the same name replaces the first. NaN and infinity become `null`, because JSON has no
    /// number for them.
    pub fn note(&mut self, name: &str, value: impl Serialize) {
        let value = serde_json::to_value(value).unwrap_or(Value::Null);
        self.0.insert(name.to_owned(), value);
    }

    /// The figures.
    pub fn as_map(&self) -> &Map<String, Value> {
        &self.0
    }
}

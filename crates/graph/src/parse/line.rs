//! Parses a line in one pass; an error names the field.

use std::cell::Cell;
use std::fmt;

use serde::Deserialize;
use serde::de::{DeserializeSeed, Deserializer, Error as _, MapAccess, Visitor};
use serde_json::Value;

use super::key::Key;
use crate::Extra;
use crate::error::Problem;

/// Fields of one kind of record, filled one by one.
pub(super) trait Fields: Sized {
    /// Takes the value of `key`. If the key is unknown, leaves the value in `map` and returns the key's name.
    fn take<'de, A: MapAccess<'de>>(&mut self, key: &Key, map: &mut A) -> Result<Option<String>, A::Error>;
    fn extra(&mut self) -> &mut Extra;
    fn id(&self) -> Option<u64> {
        None
    }
}

/// The position of the parser: an error message needs it, and the JSON library's own error lacks it.
#[derive(Default)]
struct Place {
    field: Cell<&'static str>,
    id: Cell<Option<u64>>,
}

struct Seed<'a, F> {
    fields: F,
    place: &'a Place,
}

impl<'de, F: Fields> DeserializeSeed<'de> for Seed<'_, F> {
    type Value = F;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<F, D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de, F: Fields> Visitor<'de> for Seed<'_, F> {
    type Value = F;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("one JSON object per line")
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut map: A) -> Result<F, A::Error> {
        let mut has_kind = false;
        while let Some(key) = map.next_key::<Key>()? {
            self.place.field.set(key.known_name());
            if key.name() == "kind" {
                if std::mem::replace(&mut has_kind, true) {
                    return Err(A::Error::custom("the field occurs twice"));
                }
                map.next_value::<serde::de::IgnoredAny>()?;
                continue;
            }
            if let Some(name) = self.fields.take(&key, &mut map)? {
                let value: Value = map.next_value()?;
                if self.fields.extra().insert(name.clone(), value).is_some() {
                    return Err(A::Error::custom(format!("the field \"{name}\" occurs twice")));
                }
            }
            self.place.id.set(self.fields.id());
            self.place.field.set("");
        }
        Ok(self.fields)
    }
}

pub(super) fn parse<F: Fields>(line: &str, kind: &str, fields: F) -> Result<F, Problem> {
    let place = Place::default();
    let mut deserializer = serde_json::Deserializer::from_str(line);
    let result = Seed { fields, place: &place }
        .deserialize(&mut deserializer)
        .and_then(|fields| deserializer.end().map(|()| fields));
    result.map_err(|error| {
        let mut problem = explain(line, &error);
        problem.record = Some(place.id.get().map_or_else(|| kind.to_owned(), |id| format!("{kind} {id}")));
        let field = place.field.get();
        problem.field = (!field.is_empty()).then(|| field.to_owned());
        problem
    })
}

/// Rewords an error of the JSON library in the terms of this format.
pub(super) fn explain(line: &str, error: &serde_json::Error) -> Problem {
    let message = error.to_string();
    let message = message.split(" at line ").next().unwrap_or_default();
    let place = format!("{message} (column {})", error.column());
    if error.is_eof() {
        return Problem::new(
            format!("the line ends in the middle of a record: {place}"),
            "the file was cut short; write or copy it again",
        );
    }
    if message.contains("number out of range") {
        return Problem::new(
            format!("a number is too large for a double: {place}"),
            "poses, measurements and costs must be finite",
        );
    }
    if error.is_syntax() {
        let before = error.column().saturating_sub(12);
        let around = line.get(before..).unwrap_or(line);
        let around = &around.as_bytes()[..around.len().min(24)];
        let around = String::from_utf8_lossy(around).to_lowercase();
        if around.contains("nan") || around.contains("inf") {
            return Problem::new(
                format!("NaN and infinity are not allowed (column {})", error.column()),
                "find out where the number was lost; omit a measurement that does not exist",
            );
        }
        return Problem::new(
            format!("this is not JSON: {place}"),
            "write one JSON object per line, in UTF-8",
        );
    }
    Problem::new(place, "see the format's description in crates/graph/README.md")
}

/// Takes an optional field; `null` counts as absent.
pub(super) fn once<'de, A: MapAccess<'de>, T: Deserialize<'de>>(
    map: &mut A,
    slot: &mut Option<T>,
) -> Result<Option<String>, A::Error> {
    if slot.is_some() {
        return Err(A::Error::custom("the field occurs twice"));
    }
    *slot = map.next_value()?;
    Ok(None)
}

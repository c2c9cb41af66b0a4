//! Compares one file with its recorded values.

use toml::Value;

use super::Row;
use crate::fingerprint::{ids, listed};
use crate::{Expected, Fingerprint, Measured};

pub(super) fn compare(expected: &Expected, measured: &Measured) -> Row {
    let mut row = Row {
        name: measured.file.clone(),
        stage: measured.stage.clone(),
        failures: Vec::new(),
        notes: Vec::new(),
        largest: None,
        tasks: measured.tasks.clone(),
    };
    match &measured.found {
        Err(error) => row.failures.push(error.clone()),
        Ok(found) => {
            let exact = expected.exact.iter().find(|recorded| recorded.file == measured.file);
            let close = expected.close.iter().find(|recorded| recorded.file == measured.file);
            if exact.is_none() && close.is_none() {
                row.failures.push(
                    "has no expectation yet; inspect it, then record it with `make accept-results`"
                        .to_owned(),
                );
                return row;
            }
            if let Some(recorded) = exact {
                for (name, value) in &recorded.values {
                    same(&mut row, found, name, value);
                }
            }
            if let Some(recorded) = close {
                for (name, value) in &recorded.values {
                    near(&mut row, expected, found, name, *value);
                }
            }
        }
    }
    row
}

fn same(row: &mut Row, found: &Fingerprint, name: &str, value: &Value) {
    match found.exact.get(name) {
        Some(other) if other == value => row.notes.push(format!("{name}: as expected")),
        Some(other) => row.failures.push(difference(name, value, other)),
        None => row.failures.push(format!("{name}: expected {value}, but it is missing")),
    }
}

/// Describes a change; for lists of ids, names the added and the removed ids.
pub(super) fn difference(name: &str, expected: &Value, found: &Value) -> String {
    let (Value::String(before), Value::String(after)) = (expected, found) else {
        return format!("{name}: expected {expected}, found {found}");
    };
    let (before, after) = (ids(before), ids(after));
    let mut parts = Vec::new();
    if after.difference(&before).next().is_some() {
        parts.push(format!("now also {}", listed(after.difference(&before).copied())));
    }
    if before.difference(&after).next().is_some() {
        parts.push(format!("no longer {}", listed(before.difference(&after).copied())));
    }
    format!("{name}: {}", parts.join("; "))
}

fn near(row: &mut Row, expected: &Expected, found: &Fingerprint, name: &str, value: f64) {
    let Some(&other) = found.close.get(name) else {
        row.failures.push(format!("{name}: expected {value}, but it is missing"));
        return;
    };
    let tolerance = match expected.tolerance_of(name) {
        Ok(tolerance) => tolerance,
        Err(error) => {
            row.failures.push(error.to_string());
            return;
        }
    };
    let allowed = tolerance.absolute + tolerance.relative * value.abs();
    let distance = (other - value).abs();
    if distance <= allowed {
        row.notes.push(format!("{name}: {other}, off by {distance:.2e} of {allowed:.2e} allowed"));
    } else {
        // NaN comes here too.
        row.failures.push(format!(
            "{name}: expected {value}, found {other}, off by {distance:.3e} where {allowed:.1e} is allowed ({})",
            tolerance.reason
        ));
    }
    let share = if allowed > 0.0 { distance / allowed } else { distance };
    if row.largest.as_ref().is_none_or(|(largest, _)| share > *largest) {
        row.largest = Some((share, name.to_owned()));
    }
}

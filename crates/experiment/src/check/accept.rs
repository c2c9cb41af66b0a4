//! Records results as the new expectations.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use anyhow::bail;
use toml::Value;

use super::compare::difference;
use crate::{Close, Expected, Plan, Recorded, measure};

/// Replaces the rows of the files that a plan makes; other rows stay. Returns the new expectations and the changes, one a line.
pub fn accept(expected: &Expected, plan: &Plan, results: &Path) -> anyhow::Result<(Expected, String)> {
    let mut exact: BTreeMap<String, Recorded<Value>> =
        expected.exact.iter().map(|row| (row.file.clone(), row.clone())).collect();
    let mut close: BTreeMap<String, Close> =
        expected.close.iter().map(|row| (row.file.clone(), row.clone())).collect();
    let mut changes = String::new();
    for row in measure(plan, &expected.cover, results) {
        let found = match row.found {
            Ok(found) => found,
            Err(error) => bail!("nothing was recorded, because a result cannot be used: {error}"),
        };
        for name in found.close.keys() {
            expected.tolerance_of(name)?;
        }
        let Recorded { file, stage, .. } =
            Close { file: row.file, stage: row.stage, values: BTreeMap::new() };
        let old = exact.get(&file).map(|row| row.values.clone()).unwrap_or_default();
        note_changes(&mut changes, &file, &old, &found.exact, |name, old, new| {
            (old != new).then(|| difference(name, old, new))
        });
        let before = close.get(&file).map(|row| row.values.clone()).unwrap_or_default();
        let kept: BTreeMap<String, f64> = found
            .close
            .iter()
            .map(|(name, new)| {
                // Keep the recorded number if the new one is within its tolerance, so that noise changes nothing.
                let old = before.get(name).copied().filter(|old| within(expected, name, *old, *new));
                (name.clone(), old.unwrap_or(*new))
            })
            .collect();
        note_changes(&mut changes, &file, &before, &kept, |name, old, new| {
            (old != new).then(|| format!("{name}: {old} -> {new}"))
        });
        if !found.exact.is_empty() {
            exact.insert(
                file.clone(),
                Recorded { file: file.clone(), stage: stage.clone(), values: found.exact },
            );
        }
        close.insert(file.clone(), Recorded { file, stage, values: kept });
    }
    let mut next = expected.clone();
    next.exact = exact.into_values().collect();
    next.close = close.into_values().collect();
    if changes.is_empty() {
        changes.push_str("nothing changed\n");
    }
    Ok((next, changes))
}

fn within(expected: &Expected, name: &str, old: f64, new: f64) -> bool {
    expected
        .tolerance_of(name)
        .is_ok_and(|tolerance| (old - new).abs() <= tolerance.absolute + tolerance.relative * old.abs())
}

fn note_changes<T>(
    changes: &mut String,
    file: &str,
    old: &BTreeMap<String, T>,
    new: &BTreeMap<String, T>,
    change: impl Fn(&str, &T, &T) -> Option<String>,
) {
    // Writing to a string cannot fail.
    if old.is_empty() && !new.is_empty() {
        let _ = writeln!(changes, "{file}: new, {}", posecut_stage::counted(new.len(), "value"));
        return;
    }
    for (name, value) in new {
        let said = match old.get(name) {
            Some(before) => change(name, before, value),
            None => Some(format!("{name}: new")),
        };
        if let Some(said) = said {
            let _ = writeln!(changes, "{file}: {said}");
        }
    }
    for name in old.keys().filter(|name| !new.contains_key(*name)) {
        let _ = writeln!(changes, "{file}: {name}: removed");
    }
}

//! The points of a grid, and their values in options.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context as _, bail};

use crate::{Experiment, Grid};

/// The values of all parameters at one point of a grid.
#[derive(Clone, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Point(pub BTreeMap<String, String>);

impl Point {
    /// All points of a grid: the product of its axes. Other parameters have their declared values.
    pub fn all(experiment: &Experiment, grid: &Grid) -> Vec<Self> {
        let mut points = vec![Self(experiment.parameters.clone())];
        for (name, values) in &grid.axes {
            points = points
                .iter()
                .flat_map(|point| {
                    values.iter().map(move |value| {
                        let mut point = point.clone();
                        point.0.insert(name.clone(), value.clone());
                        point
                    })
                })
                .collect();
        }
        points
    }

    /// Replaces `{name}` in words by parameter values. A word that consists of one parameter only is split into the words of its
    /// value; an empty value gives no word.
    pub fn fill(&self, experiment: &Experiment, words: &[String]) -> anyhow::Result<Vec<String>> {
        let mut filled = Vec::new();
        for word in words {
            let value = replace(word, |name| self.value(experiment, name))?;
            let alone = word.starts_with('{') && word.find('}') == Some(word.len() - 1);
            if alone {
                filled.extend(value.split_whitespace().map(str::to_owned));
            } else {
                filled.push(value);
            }
        }
        Ok(filled)
    }

    fn value(&self, experiment: &Experiment, name: &str) -> anyhow::Result<String> {
        if let Some(value) = self.0.get(name) {
            return Ok(value.clone());
        }
        let derived = experiment.derived.get(name).with_context(|| {
            format!("\"{{{name}}}\" in the options is not a parameter; declare it under [parameters]")
        })?;
        let text = &self.0[&derived.of];
        if !derived.texts.is_empty() {
            return derived.texts.get(text).or(derived.otherwise.as_ref()).cloned().with_context(|| {
                format!("derived.{name} has no text for {} = {text}; add it, or set `otherwise`", derived.of)
            });
        }
        let base: f64 = text.parse().with_context(|| {
            format!("\"{name}\" is computed from {}, but \"{text}\" is not a number", derived.of)
        })?;
        let value = derived.factor * base.powf(derived.power);
        if !value.is_finite() {
            bail!("\"{name}\" is not a finite number for {} = {text}", derived.of);
        }
        Ok(six_digits(value))
    }

    /// The part of a path that distinguishes the values of these parameters; empty without parameters.
    pub fn folder(&self, names: &BTreeSet<String>) -> String {
        let parts: Vec<String> =
            names.iter().filter_map(|name| Some(format!("{name}={}", self.0.get(name)?))).collect();
        parts.join(",")
    }
}

/// The declared parameters that options depend on, directly or through derived ones.
pub(crate) fn used<'a>(experiment: &Experiment, words: impl Iterator<Item = &'a String>) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for word in words {
        // Only the names matter here, so the result is ignored. `fill` reports unknown names.
        let _ = replace(word, |name| {
            let name = experiment.derived.get(name).map_or(name, |derived| derived.of.as_str());
            if experiment.parameters.contains_key(name) {
                names.insert(name.to_owned());
            }
            Ok(String::new())
        });
    }
    names
}

pub(crate) fn replace(
    word: &str,
    mut value: impl FnMut(&str) -> anyhow::Result<String>,
) -> anyhow::Result<String> {
    let mut text = String::new();
    let mut rest = word;
    while let Some((before, after)) = rest.split_once('{') {
        let Some((name, after)) = after.split_once('}') else { break };
        text.push_str(before);
        text.push_str(&value(name)?);
        rest = after;
    }
    text.push_str(rest);
    Ok(text)
}

/// Writes six significant digits without trailing zeros: 0.1 * 3 becomes 0.3.
fn six_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    rounded.to_string()
}

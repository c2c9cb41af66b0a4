//! The parts of a declaration that are tables of their own: steps and grids.

use std::collections::BTreeMap;

use anyhow::{Context as _, bail};
use toml::Value;

/// One step: a stage program with options.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// The program's name in the list of stages; by default the name of the step.
    pub program: Option<String>,
    /// The options of the program; `{name}` is replaced by a parameter's value.
    pub options: Vec<String>,
}

/// All combinations of the values of some parameters, for some of the methods, sessions and seeds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    /// Values of each parameter that varies.
    pub axes: BTreeMap<String, Vec<String>>,
    /// Instead of the experiment's methods.
    pub methods: Option<Vec<String>>,
    /// Instead of the experiment's sessions.
    pub sessions: Option<Vec<String>>,
    /// Sessions that this block leaves out, even if they were requested.
    pub except: Vec<String>,
    /// Instead of the experiment's number of seeds.
    pub seeds: Option<u64>,
}

/// Options as words.
pub(crate) fn words(options: &str) -> Vec<String> {
    options.split_whitespace().map(str::to_owned).collect()
}

/// A step: its options alone, or a table.
pub(super) fn step(value: &Value) -> anyhow::Result<Step> {
    let options = |value: &Value| match value {
        Value::String(text) => Ok(words(text)),
        Value::Array(items) => items.iter().map(scalar).collect(),
        other => bail!("options must be text or a list of words, not {other}"),
    };
    let Value::Table(table) = value else {
        return Ok(Step { program: None, options: options(value)? });
    };
    if let Some(name) = table.keys().find(|name| !["program", "options"].contains(&name.as_str())) {
        bail!("a step can have \"program\" and \"options\", but not \"{name}\"");
    }
    Ok(Step {
        program: table.get("program").map(scalar).transpose()?,
        options: table.get("options").map(options).transpose()?.unwrap_or_default(),
    })
}

/// The text of a value, for options and labels.
pub(super) fn scalar(value: &Value) -> anyhow::Result<String> {
    Ok(match value {
        Value::String(text) => text.clone(),
        Value::Integer(number) => number.to_string(),
        Value::Float(number) if number.is_finite() => number.to_string(),
        Value::Boolean(truth) => truth.to_string(),
        other => bail!("expected a number or text, found {other}"),
    })
}

/// A block of parameter values.
pub(super) fn grid(table: &BTreeMap<String, Value>) -> anyhow::Result<Grid> {
    let mut grid = Grid::default();
    for (name, value) in table {
        let list = || match value {
            Value::Array(items) => items.iter().map(scalar).collect::<anyhow::Result<Vec<_>>>(),
            one => Ok(vec![scalar(one)?]),
        };
        match name.as_str() {
            "methods" => grid.methods = Some(list()?),
            "sessions" => grid.sessions = Some(list()?),
            "except" => grid.except = list()?,
            "seeds" => {
                let seeds = value.as_integer().and_then(|seeds| u64::try_from(seeds).ok());
                grid.seeds = Some(seeds.context("the seeds of a grid must be a number, at least 0")?);
            }
            _ => {
                grid.axes.insert(name.clone(), list().with_context(|| format!("grid, {name}"))?);
            }
        }
    }
    Ok(grid)
}

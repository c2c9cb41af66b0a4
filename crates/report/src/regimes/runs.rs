//! Assigns runs to the cells of the map by their labels.

use std::collections::BTreeMap;

use anyhow::Context as _;

use crate::results::RunResult;

/// The end of the names of simulated sessions: a real session may have the same date.
pub(super) const SIMULATED: &str = " (simulated)";

/// The kind of false edges for which the whole grid is swept.
pub(super) const UNIFORM: &str = "uniform";

/// The figures of a run.
pub(super) struct Run {
    pub rmse: f64,
    pub precision: Option<f64>,
    pub recall: Option<f64>,
}

/// Runs by seed.
pub(super) type Seeds = BTreeMap<String, Run>;

/// The cell of a run: session, kind, method, rate, scale.
pub(super) type Place = (String, String, String, usize, usize);

/// The sessions that have runs with a kind of false edges.
pub(super) fn having(runs: &BTreeMap<Place, Seeds>, sessions: &[String], kind: &str) -> Vec<String> {
    let has = |session: &String| runs.keys().any(|place| place.0 == *session && place.1 == kind);
    sessions.iter().filter(|session| has(session)).cloned().collect()
}

/// One stratum a session; `None` if there are no sessions, or one has no runs in the cell.
pub(super) fn strata<'a>(
    runs: &'a BTreeMap<Place, Seeds>,
    sessions: &[String],
    kind: &str,
    method: &str,
    rate: usize,
    scale: usize,
) -> Option<Vec<&'a Seeds>> {
    let strata: Option<Vec<_>> = sessions
        .iter()
        .map(|session| runs.get(&(session.clone(), kind.to_owned(), method.to_owned(), rate, scale)))
        .collect();
    strata.filter(|strata| !strata.is_empty())
}

/// The session's name; the pipeline tells whether it is simulated.
pub(super) fn session(result: &RunResult) -> String {
    let suffix = if result.label("pipeline").ends_with("-simulated") { SIMULATED } else { "" };
    format!("{}{suffix}", result.label("session"))
}

pub(super) fn kind(result: &RunResult) -> String {
    let kind = result.label("incorrect_kind");
    if kind.is_empty() { UNIFORM.to_owned() } else { kind }
}

pub(super) fn number(result: &RunResult, name: &str) -> anyhow::Result<f64> {
    let text = result.label(name);
    let said = || {
        let run = format!(
            "{} on {}, seed {}",
            result.label("method"),
            result.label("session"),
            result.label("seed")
        );
        if text.is_empty() {
            format!("the result of {run} has no label {name}; evaluate with --label {name}=NUMBER")
        } else {
            format!(
                "the result of {run} has the label {name}={text}, but needs a finite number; correct the label"
            )
        }
    };
    text.parse::<f64>().ok().filter(|value| value.is_finite()).with_context(said)
}

//! Tables of methods (rows) by sessions (columns).

mod csv_rows;
mod doubts;
mod hostile_text;
mod latex;
mod markdown;

pub use csv_rows::write_csv;
pub(crate) use doubts::{Doubts, MARK, is_silently_disconnected, listed};
pub(crate) use hostile_text::{cell_text, inline};
pub use latex::latex;
pub(crate) use markdown::grid;
pub use markdown::markdown;

use std::collections::BTreeMap;

use crate::results::RunResult;

/// Mean and standard deviation of one method on one session over seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell {
    /// Mean RMSE, metres.
    pub mean: f64,
    /// Sample standard deviation over seeds; absent for a single seed.
    pub deviation: Option<f64>,
    /// Number of seeds.
    pub seeds: usize,
    /// Mean number of incorrect edges in use.
    pub false_kept: f64,
    /// Mean number of incorrect edges.
    pub false_all: f64,
    /// Mean number of correct edges in use.
    pub true_kept: f64,
    /// Mean number of correct edges.
    pub true_all: f64,
    /// Number of seeds whose graph fell into several components.
    pub disconnected: usize,
    /// Number of those that have no doubt about it, as in results of older programs.
    pub silently_disconnected: usize,
    /// Number of seeds with each doubt, by stage and doubt.
    pub(crate) doubts: Doubts,
}

impl Cell {
    /// The mark after the value: a dagger if there is a reason to mistrust it.
    pub(crate) fn mark(&self) -> &'static str {
        if self.disconnected > 0 || !self.doubts.is_empty() { MARK } else { "" }
    }
}

/// One experiment's results: a cell for each method and session.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The experiment's name.
    pub pipeline: String,
    /// Columns, sorted; sessions without data are included.
    pub sessions: Vec<String>,
    /// Rows in the requested order.
    pub methods: Vec<Row>,
}

/// One method.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The method's name.
    pub method: String,
    /// One cell a session; `None` where there is no data.
    pub cells: Vec<Option<Cell>>,
}

impl Row {
    /// The mean over the sessions that have data.
    pub fn mean(&self) -> Option<f64> {
        let means: Vec<f64> = self.cells.iter().flatten().map(|cell| cell.mean).collect();
        (!means.is_empty()).then(|| means.iter().sum::<f64>() / means.len() as f64)
    }
}

/// Builds one table an experiment. `methods` orders the rows (other methods follow by name); `missing` names requested
/// sessions that have no data.
pub fn tables(results: &[RunResult], methods: &[String], missing: &[String]) -> Vec<Table> {
    let mut pipelines: Vec<String> = results.iter().map(|result| result.label("pipeline")).collect();
    pipelines.sort();
    pipelines.dedup();
    pipelines
        .into_iter()
        .map(|pipeline| {
            let own: Vec<&RunResult> =
                results.iter().filter(|result| result.label("pipeline") == pipeline).collect();
            table(pipeline, &own, methods, missing)
        })
        .collect()
}

fn table(pipeline: String, results: &[&RunResult], methods: &[String], missing: &[String]) -> Table {
    let distinct = |name: &str| {
        let mut values: Vec<String> = results.iter().map(|result| result.label(name)).collect();
        values.sort();
        values.dedup();
        values
    };
    let mut sessions = distinct("session");
    sessions.extend(missing.iter().cloned());
    sessions.sort();
    sessions.dedup();
    // Rows in the requested order, then by name; runs with replaced stages have a row of their own.
    let position =
        |method: &String| methods.iter().position(|other| other == method).unwrap_or(methods.len());
    let mut rows: BTreeMap<(usize, String, String), Vec<&RunResult>> = BTreeMap::new();
    for run in results {
        let method = run.label("method");
        rows.entry((position(&method), method, run.label("replaced"))).or_default().push(run);
    }
    let methods = rows
        .into_iter()
        .map(|((_, method, replaced), runs)| {
            let of_session = |session: &String| {
                cell(&runs.iter().copied().filter(|run| run.label("session") == *session).collect::<Vec<_>>())
            };
            Row { method: row_name(method, &replaced), cells: sessions.iter().map(of_session).collect() }
        })
        .collect();
    Table { pipeline, sessions, methods }
}

/// The method, and which programs replaced its stages: `pcm (pcm = ./my-stage)`.
fn row_name(method: String, replaced: &str) -> String {
    if replaced.is_empty() { method } else { format!("{method} ({replaced})") }
}

fn cell(runs: &[&RunResult]) -> Option<Cell> {
    if runs.is_empty() {
        return None;
    }
    let count = runs.len() as f64;
    let mean = runs.iter().map(|run| run.rmse).sum::<f64>() / count;
    let deviation = (runs.len() > 1)
        .then(|| (runs.iter().map(|run| (run.rmse - mean).powi(2)).sum::<f64>() / (count - 1.0)).sqrt());
    let edges: Vec<_> = runs.iter().filter_map(|run| run.edges).collect();
    let average = |pick: fn(&crate::results::Edges) -> usize| {
        edges.iter().map(pick).sum::<usize>() as f64 / edges.len().max(1) as f64
    };
    Some(Cell {
        mean,
        deviation,
        seeds: runs.len(),
        false_kept: average(|edges| edges.false_positive),
        false_all: average(|edges| edges.false_positive + edges.true_negative),
        true_kept: average(|edges| edges.true_positive),
        true_all: average(|edges| edges.true_positive + edges.false_negative),
        disconnected: runs.iter().filter(|run| run.components > 1).count(),
        silently_disconnected: runs.iter().filter(|run| run.components > 1 && !says_so(run)).count(),
        doubts: doubts::doubts(runs.iter().copied()),
    })
}

/// Whether a doubt of a run reports several components.
fn says_so(run: &RunResult) -> bool {
    run.doubts.iter().any(|found| found.doubt == posecut_stage::Doubt::PartsNotConnected.name())
}

/// Metres with two decimals below ten and one decimal above.
pub(crate) fn metres(value: f64) -> String {
    if value.abs() < 10.0 { format!("{value:.2}") } else { format!("{value:.1}") }
}

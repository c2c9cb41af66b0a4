//! `cargo xtask edges-table`: writes landmark edges of collected results as a table of a document.

use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use glob::Pattern;
use serde::Deserialize;
use serde_json::{Map, Value};
use xtask::sections::replace;

use crate::Verdict;
use crate::markdown::table;

/// Write a table of landmark edges from collected results into a document
#[derive(Args)]
pub(crate) struct EdgesTable {
    /// The output of `posecut-experiment collect`
    results: PathBuf,
    /// Make one row for each combination of values of these labels, separated by commas
    #[arg(long, value_delimiter = ',', required = true)]
    rows: Vec<String>,
    /// Make one column for each value of this label, or for each of these patterns of sessions and graphs.
    ///
    /// The runs that match a pattern are added up. NAME=PATTERN names the column.
    #[arg(long, num_args = 1.., required = true)]
    columns: Vec<String>,
    /// Choose the content of a cell
    #[arg(long, default_value = "precision-recall")]
    cell: Shown,
    /// Write the table into this document
    #[arg(short, long)]
    output: PathBuf,
    /// Replace this section of the document
    #[arg(long)]
    section: String,
}

#[derive(Clone, Copy, ValueEnum)]
enum Shown {
    /// Precision and recall of the edges of all runs together
    PrecisionRecall,
    /// False edges kept, correct edges lost, mean RMSE in metres
    KeptLostRmse,
}

#[derive(Deserialize)]
struct Run {
    labels: Map<String, Value>,
    edges: Option<Edges>,
    rmse: Option<f64>,
    failed: Option<Value>,
}

#[derive(Clone, Copy, Deserialize)]
struct Edges {
    true_positive: u64,
    false_positive: u64,
    false_negative: u64,
}

impl EdgesTable {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let place = || format!("{}: cannot be used", self.results.display());
        let text = std::fs::read_to_string(&self.results).with_context(place)?;
        let runs: Result<Vec<Run>, _> = text.lines().map(serde_json::from_str).collect();
        let runs = runs.with_context(place)?;
        if runs.is_empty() {
            bail!("{}: has no results; run the experiment first", self.results.display());
        }
        let lines = lines(&runs, &self.rows, &self.columns, self.cell)?;
        replace(&self.output, &self.section, &lines.join("\n"))?;
        Ok(Verdict::Holds)
    }
}

/// A label of a run, as text for a table.
fn label(run: &Run, name: &str) -> String {
    match run.labels.get(name) {
        Some(Value::String(text)) => text.clone(),
        Some(value) => value.to_string(),
        None => "–".to_owned(),
    }
}

/// The runs of a column.
enum Column {
    Value(String, String),
    Sessions(Pattern),
}

impl Column {
    fn has(&self, run: &Run) -> bool {
        match self {
            Self::Value(name, value) => label(run, name) == *value,
            Self::Sessions(pattern) => pattern.matches(&label(run, "session")),
        }
    }
}

fn unique<T: PartialEq>(values: impl Iterator<Item = T>) -> Vec<T> {
    values.fold(Vec::new(), |mut all, value| {
        if !all.contains(&value) {
            all.push(value);
        }
        all
    })
}

fn lines(runs: &[Run], rows: &[String], columns: &[String], shown: Shown) -> anyhow::Result<Vec<String>> {
    let row_of = |run: &Run| -> Vec<String> { rows.iter().map(|name| label(run, name)).collect() };
    let chosen: Vec<(String, Column)> = match columns {
        [name] if !name.contains('=') && runs.iter().all(|run| run.labels.contains_key(name)) => {
            let values = unique(runs.iter().map(|run| label(run, name)));
            values.into_iter().map(|value| (value.clone(), Column::Value(name.clone(), value))).collect()
        }
        patterns => {
            let column = |text: &String| {
                let (name, pattern) = text.split_once('=').unwrap_or((text, text));
                let pattern = Pattern::new(pattern).with_context(|| format!("--columns {text}"))?;
                Ok((name.to_owned(), Column::Sessions(pattern)))
            };
            patterns.iter().map(column).collect::<anyhow::Result<_>>()?
        }
    };
    let head: Vec<String> = rows.iter().chain(chosen.iter().map(|(name, _)| name)).cloned().collect();
    let body = unique(runs.iter().map(row_of)).into_iter().map(|row| {
        let cells = chosen.iter().map(|(_, column)| {
            cell(&runs.iter().filter(|run| row_of(run) == row && column.has(run)).collect::<Vec<_>>(), shown)
        });
        row.iter().cloned().map(Ok).chain(cells).collect()
    });
    Ok(table(&head, rows.len(), &body.collect::<anyhow::Result<Vec<_>>>()?))
}

fn cell(runs: &[&Run], shown: Shown) -> anyhow::Result<String> {
    if runs.is_empty() {
        return Ok("–".to_owned());
    }
    let failed = runs.iter().filter(|run| run.failed.is_some()).count();
    if failed > 0 {
        return Ok(format!("{failed} of {} failed", runs.len()));
    }
    let edges: Option<Vec<Edges>> = runs.iter().map(|run| run.edges).collect();
    let edges = edges.context("a result has no edges; collect the results again")?;
    let sum = |count: fn(&Edges) -> u64| edges.iter().map(count).sum::<u64>() as f64;
    let (correct, wrong) = (sum(|edges| edges.true_positive), sum(|edges| edges.false_positive));
    let lost = sum(|edges| edges.false_negative);
    Ok(match shown {
        Shown::PrecisionRecall => {
            let share = |all: f64| if all == 0.0 { 1.0 } else { correct / all };
            format!("{:.3} / {:.3}", share(correct + wrong), share(correct + lost))
        }
        Shown::KeptLostRmse => {
            let rmse: Option<f64> = runs.iter().map(|run| run.rmse).sum();
            let rmse = rmse.context("a result has no RMSE; collect the results again")?;
            format!("{wrong} / {lost} / {:.2}", rmse / runs.len() as f64)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs() -> Vec<Run> {
        let run = |method: &str, session: &str, counts: [u64; 3], rmse: f64| {
            format!(
                r#"{{"labels": {{"method": "{method}", "session": "{session}", "chance": 3}}, "rmse": {rmse},
                "edges": {{"true_positive": {}, "false_positive": {}, "false_negative": {}}}}}"#,
                counts[0], counts[1], counts[2]
            )
        };
        let mut texts = vec![
            run("pcm", "kitti_05_1", [8, 2, 0], 1.0),
            run("pcm", "kitti_05_2", [1, 0, 1], 2.0),
            run("none", "MIT", [0, 0, 5], 0.5),
        ];
        texts.push(r#"{"labels": {"method": "none", "session": "kitti_05_1"}, "failed": "why"}"#.to_owned());
        texts.iter().map(|text| serde_json::from_str(text).unwrap()).collect()
    }

    fn words(words: &[&str]) -> Vec<String> {
        words.iter().map(|&word| word.to_owned()).collect()
    }

    #[test]
    fn patterns_add_runs_up() {
        let columns = words(&["kitti=kitti_05_*", "[iM][nI]*"]);
        let lines = lines(&runs(), &words(&["method", "chance"]), &columns, Shown::KeptLostRmse).unwrap();
        assert_eq!(
            lines,
            [
                "| method | chance | kitti | [iM][nI]* |",
                "|---|---|---:|---:|",
                "| pcm | 3 | 2 / 1 / 1.50 | – |",
                "| none | 3 | – | 0 / 5 / 0.50 |",
                "| none | – | 1 of 1 failed | – |",
            ]
        );
    }

    #[test]
    fn the_values_of_a_label_are_columns() {
        let lines =
            lines(&runs(), &words(&["method"]), &words(&["session"]), Shown::PrecisionRecall).unwrap();
        assert_eq!(lines[0], "| method | kitti_05_1 | kitti_05_2 | MIT |");
        assert_eq!(lines[2], "| pcm | 0.800 / 1.000 | 1.000 / 0.500 | – |");
        assert_eq!(lines[3], "| none | 1 of 1 failed | – | 1.000 / 0.000 |");
    }
}

//! One row a run, for spreadsheets and data frames.

use anyhow::Context as _;

use super::hostile_text::cell_text;
use crate::results::RunResult;

/// All runs, one a row.
pub fn write_csv(results: &[RunResult]) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "pipeline",
        "method",
        "session",
        "seed",
        "rmse_m",
        "components",
        "true_positive",
        "false_positive",
        "false_negative",
        "true_negative",
    ])?;
    for result in results {
        let count = |pick: fn(&crate::results::Edges) -> usize| {
            result.edges.as_ref().map_or_else(String::new, |edges| pick(edges).to_string())
        };
        writer.write_record([
            cell_text(result.label("pipeline")),
            cell_text(result.label("method")),
            cell_text(result.label("session")),
            cell_text(result.label("seed")),
            result.rmse.to_string(),
            result.components.to_string(),
            count(|edges| edges.true_positive),
            count(|edges| edges.false_positive),
            count(|edges| edges.false_negative),
            count(|edges| edges.true_negative),
        ])?;
    }
    writer.into_inner().context("the CSV cannot be finished")
}

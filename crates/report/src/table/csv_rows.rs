//! Writes one row a run, for spreadsheets and data frames.

use anyhow::Context as _;
use posecut_graph::StageDoubt;

use super::hostile_text::cell_text;
use crate::results::RunResult;

/// Writes all runs, one a row.
pub fn write_csv(results: &[RunResult]) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Without any doubts the column is omitted.
    let doubtful = results.iter().any(|result| !result.doubts.is_empty());
    let mut head = vec![
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
    ];
    if doubtful {
        head.push("doubts");
    }
    writer.write_record(head)?;
    for result in results {
        let count = |pick: fn(&crate::results::Edges) -> usize| {
            result.edges.as_ref().map_or_else(String::new, |edges| pick(edges).to_string())
        };
        let mut row = vec![
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
        ];
        if doubtful {
            let each = |found: &StageDoubt| format!("{}: {}", found.stage, found.doubt);
            row.push(cell_text(result.doubts.iter().map(each).collect::<Vec<_>>().join("; ")));
        }
        writer.write_record(row)?;
    }
    writer.into_inner().context("the CSV cannot be written")
}

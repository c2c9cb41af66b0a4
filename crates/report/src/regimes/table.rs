//! Writes the map as tables.

use std::fmt::Write as _;

use anyhow::Context as _;

use super::{Map, Verdict};
use crate::table::{cell_text, grid, inline, metres};

/// A false-edge rate as text: `5 %`.
pub fn percent(rate: f64) -> String {
    format!("{} %", short(rate * 100.0))
}

/// A number without insignificant digits.
pub fn short(value: f64) -> String {
    format!("{}", (value * 1e6).round() / 1e6)
}

/// A table of false-edge rates (rows) and covariance scales (columns) for each method, then the effects of the graph
/// cut, with counts of the verdicts.
pub fn markdown(map: &Map, sessions: &[String], kinds: &[String]) -> String {
    let mut text = String::from(
        "Mean RMSE in metres over seeds, with the 95 % interval of the mean (percentile bootstrap, 2000 resamples). \
         Columns: the covariance that the odometry claims, relative to that of 0.1 m and 0.0167 rad per step; rows: share of false edges among all landmark edges. Effects are mean \
         paired differences over seeds: *helps* or *hurts* if they are significant in the sign-flip test (p at most 0.05, \
         adjusted over the cells of the table by Benjamini and Hochberg), otherwise neutral.\n\n",
    );
    for session in sessions {
        for kind in kinds {
            section(&mut text, map, session, kind);
        }
    }
    text
}

fn section(text: &mut String, map: &Map, session: &str, kind: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "### {}, {} false edges\n", inline(session), inline(kind));
    for method in &map.methods {
        let Some(own) = map.of(session, kind, method) else { continue };
        let seeds = own.cells.iter().flatten().map(|cell| cell.seeds);
        let (least, most) = (seeds.clone().min().unwrap_or(0), seeds.max().unwrap_or(0));
        let runs = if least == most { most.to_string() } else { format!("{least} to {most}") };
        let _ = writeln!(text, "**{}**, RMSE in metres ({runs} runs per cell)\n", inline(method));
        rows(text, map, |index| {
            own.cells[index]
                .map(|cell| format!("{} [{}, {}]", metres(cell.mean), metres(cell.low), metres(cell.high)))
        });
    }
    for comparison in map.compared(session, kind) {
        let count =
            |verdict| comparison.cells.iter().flatten().filter(|effect| effect.verdict == verdict).count();
        let _ = writeln!(
            text,
            "**{} against {}**, difference in metres: helps in {}, neutral in {}, hurts in {} of {} cells\n",
            inline(&comparison.with),
            inline(&comparison.without),
            count(Verdict::Helps),
            count(Verdict::Neutral),
            count(Verdict::Hurts),
            comparison.cells.iter().flatten().count()
        );
        rows(text, map, |index| {
            comparison.cells[index].map(|effect| {
                let verdict = match effect.verdict {
                    Verdict::Neutral => String::new(),
                    other => format!(" {}", other.name()),
                };
                format!("{}{verdict}", signed(effect.difference))
            })
        });
    }
}

fn rows(text: &mut String, map: &Map, cell: impl Fn(usize) -> Option<String>) {
    let mut rows = vec![vec!["rate \\ scale".to_owned()]];
    rows[0].extend(map.scales.iter().map(|scale| short(*scale)));
    for (row, rate) in map.rates.iter().enumerate() {
        let mut cells = vec![percent(*rate)];
        cells.extend(
            (0..map.scales.len())
                .map(|column| cell(map.index(row, column)).unwrap_or_else(|| "no data".to_owned())),
        );
        rows.push(cells);
    }
    grid(text, &rows);
}

/// Metres with their sign, with a true minus sign.
pub fn signed(value: f64) -> String {
    let text = metres(value.abs());
    match value {
        _ if text.chars().all(|digit| digit == '0' || digit == '.') => text,
        _ if value < 0.0 => format!("−{text}"),
        _ => format!("+{text}"),
    }
}

/// One row for each session, kind, method, rate and scale. Effects have columns of their own, which are empty for a
/// method without a counterpart.
pub fn csv(map: &Map, sessions: &[String], kinds: &[String]) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "session",
        "incorrect_kind",
        "method",
        "incorrect_rate",
        "covariance_scale",
        "runs",
        "rmse_mean_m",
        "rmse_low_m",
        "rmse_high_m",
        "precision_mean",
        "recall_mean",
        "without",
        "difference_mean_m",
        "difference_low_m",
        "difference_high_m",
        "p_adjusted",
        "verdict",
    ])?;
    let optional = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for own in map.maps.iter().filter(|own| sessions.contains(&own.session) && kinds.contains(&own.kind)) {
        let comparison =
            map.compared(&own.session, &own.kind).find(|comparison| comparison.with == own.method);
        for (index, cell) in own.cells.iter().enumerate() {
            let Some(cell) = cell else { continue };
            let mut row = vec![
                cell_text(own.session.clone()),
                cell_text(own.kind.clone()),
                cell_text(own.method.clone()),
                short(map.rates[index / map.scales.len()]),
                short(map.scales[index % map.scales.len()]),
                cell.seeds.to_string(),
                cell.mean.to_string(),
                cell.low.to_string(),
                cell.high.to_string(),
                optional(cell.precision),
                optional(cell.recall),
            ];
            match comparison.and_then(|comparison| Some((&comparison.without, comparison.cells[index]?))) {
                None => row.extend(std::iter::repeat_n(String::new(), 6)),
                Some((without, effect)) => row.extend([
                    without.clone(),
                    effect.difference.to_string(),
                    effect.low.to_string(),
                    effect.high.to_string(),
                    effect.p.to_string(),
                    effect.verdict.name().to_owned(),
                ]),
            }
            writer.write_record(row)?;
        }
    }
    writer.into_inner().context("the CSV cannot be written")
}

//! The tables of docs/regimes.md.

use std::fmt::Write as _;

use super::{Interval, Samples};

/// Methods in the order of columns.
const METHODS: &[&str] = &["none", "pcm", "pcm-root", "gc", "pcm+gc"];

/// One table of the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Section {
    /// What GC changes after PCM: helps, neutral, or costs
    Verdict,
    /// RMSE of every method under uniform mistakes
    Uniform,
    /// RMSE of every method under each kind of mistakes
    Kinds,
    /// Edges kept under each kind of mistakes
    Edges,
}

impl Section {
    /// All of them, with the names of their markers.
    pub const ALL: &'static [(&'static str, Self)] = &[
        ("verdict", Self::Verdict),
        ("uniform", Self::Uniform),
        ("kinds", Self::Kinds),
        ("edges", Self::Edges),
    ];
}

/// Writes a table, Markdown.
pub fn section(samples: &Samples, section: Section) -> String {
    match section {
        Section::Verdict => verdict(samples),
        Section::Uniform => uniform(samples),
        Section::Kinds => kinds(samples),
        Section::Edges => edges(samples),
    }
}

fn rows(text: &mut String, head: &[String], rows: &[Vec<String>]) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "| {} |", head.join(" | "));
    let _ = writeln!(text, "|{}|", head.iter().map(|_| "---").collect::<Vec<_>>().join("|"));
    for row in rows {
        let _ = writeln!(text, "| {} |", row.join(" | "));
    }
    text.push('\n');
}

/// Three significant digits are more than the spread allows.
fn metres(value: f64) -> String {
    if value.abs() >= 9.95 { format!("{value:.0}") } else { format!("{value:.1}") }
}

fn written(interval: Option<Interval>) -> String {
    match interval {
        None => "–".to_owned(),
        Some(Interval { mean, half_width: None, .. }) => metres(mean),
        Some(Interval { mean, half_width: Some(half), .. }) => format!("{} ± {}", metres(mean), metres(half)),
    }
}

fn rmse(
    samples: &Samples,
    session: &str,
    kind: &str,
    rate: &str,
    scale: &str,
    method: &str,
) -> Option<Interval> {
    let runs = samples.at(session, kind, rate, scale, method)?;
    Interval::of(&runs.values().map(|run| run.rmse).collect::<Vec<_>>())
}

/// PCM's RMSE less PCM+GC's, seed by seed.
fn gain(samples: &Samples, session: &str, kind: &str, rate: &str, scale: &str) -> Option<Interval> {
    let alone = samples.at(session, kind, rate, scale, "pcm")?;
    let both = samples.at(session, kind, rate, scale, "pcm+gc")?;
    let pairs = alone.iter().filter_map(|(seed, run)| Some(run.rmse - both.get(seed)?.rmse));
    Interval::of(&pairs.collect::<Vec<_>>())
}

fn percent(rate: &str) -> String {
    rate.parse::<f64>().map_or_else(|_| rate.to_owned(), |rate| format!("{:.0} %", rate * 100.0))
}

fn verdict(samples: &Samples) -> String {
    let mut text = String::new();
    let (fewest, most) = samples.seeds();
    let seeds = if fewest == most { fewest.to_string() } else { format!("{fewest} to {most}") };
    let _ = writeln!(
        text,
        "PCM's RMSE less PCM+GC's, metres: mean over {seeds} seeds of the paired difference and its 95 % interval. **helps**: the interval \
         lies above 0; costs: below 0; otherwise no difference is shown.\n"
    );
    let scales = samples.scales("uniform");
    for session in samples.sessions() {
        let _ = writeln!(text, "{session}, uniform mistakes:\n");
        let mut head = vec!["incorrect edges".to_owned()];
        head.extend(scales.iter().map(|scale| format!("covariance × {scale}")));
        let table: Vec<Vec<String>> = samples
            .rates("uniform")
            .iter()
            .map(|rate| {
                let mut row = vec![percent(rate)];
                row.extend(scales.iter().map(|scale| judged(gain(samples, session, "uniform", rate, scale))));
                row
            })
            .collect();
        rows(&mut text, &head, &table);
    }
    text
}

fn judged(gain: Option<Interval>) -> String {
    let word = match gain {
        Some(Interval { mean, half_width: Some(half), .. }) if mean > half => "**helps** ",
        Some(Interval { mean, half_width: Some(half), .. }) if -mean > half => "costs ",
        _ => "",
    };
    format!("{word}{}", written(gain))
}

fn uniform(samples: &Samples) -> String {
    let mut text = "RMSE in metres, mean and 95 % interval over seeds.\n\n".to_owned();
    for session in samples.sessions() {
        let _ = writeln!(text, "{session}:\n");
        let mut table = Vec::new();
        for scale in samples.scales("uniform") {
            for rate in samples.rates("uniform") {
                let mut row = vec![format!("× {scale}"), percent(rate)];
                row.extend(
                    METHODS
                        .iter()
                        .map(|method| written(rmse(samples, session, "uniform", rate, scale, method))),
                );
                if row[2..].iter().any(|cell| cell != "–") {
                    table.push(row);
                }
            }
        }
        rows(&mut text, &head(&["covariance", "incorrect edges"]), &table);
    }
    text
}

fn head(first: &[&str]) -> Vec<String> {
    first.iter().chain(METHODS).map(|name| (*name).to_owned()).collect()
}

/// One row for each session, kind, scale and rate where another kind than uniform was swept.
fn each_kind(samples: &Samples, cell: impl Fn(&str, &str, &str, &str, &str) -> String) -> Vec<Vec<String>> {
    let mut table = Vec::new();
    let others: Vec<&str> = samples.kinds().into_iter().filter(|kind| *kind != "uniform").collect();
    let Some(first) = others.first() else { return table };
    for session in samples.sessions() {
        for scale in samples.scales(first) {
            for rate in samples.rates(first) {
                for kind in ["uniform"].iter().chain(&others) {
                    let mut row =
                        vec![session.to_owned(), format!("× {scale}"), percent(rate), (*kind).to_owned()];
                    row.extend(METHODS.iter().map(|method| cell(session, kind, rate, scale, method)));
                    if row[4..].iter().any(|cell| cell != "–") {
                        table.push(row);
                    }
                }
            }
        }
    }
    table
}

fn kinds(samples: &Samples) -> String {
    let mut text = "RMSE in metres, mean and 95 % interval over seeds.\n\n".to_owned();
    let table = each_kind(samples, |session, kind, rate, scale, method| {
        written(rmse(samples, session, kind, rate, scale, method))
    });
    rows(&mut text, &head(&["session", "covariance", "incorrect edges", "kind"]), &table);
    text
}

fn edges(samples: &Samples) -> String {
    let mut text =
        "Precision / recall of landmark edges in use, pooled over seeds (edges in use that are correct / correct edges in use).\n\n"
            .to_owned();
    let table = each_kind(samples, |session, kind, rate, scale, method| {
        let Some(runs) = samples.at(session, kind, rate, scale, method) else { return "–".to_owned() };
        let mut sums = [0.0; 3];
        for edges in runs.values().filter_map(|run| run.edges) {
            for (sum, value) in
                sums.iter_mut().zip([edges.true_positive, edges.false_positive, edges.false_negative])
            {
                *sum += f64::from(value);
            }
        }
        let [kept, wrong, lost] = sums;
        format!("{:.3} / {:.3}", kept / (kept + wrong).max(1.0), kept / (kept + lost).max(1.0))
    });
    rows(&mut text, &head(&["session", "covariance", "incorrect edges", "kind"]), &table);
    text
}

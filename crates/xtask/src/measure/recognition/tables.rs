//! The tables of docs/results/recognition.md.

use super::graph::Map;
use super::ranking::{Bin, ENDS, Scored, area, bins, precision_at_full_recall, recall_at_full_precision};
use super::running::{Errors, IndexTimes, STAGES, Scores, Seconds, Way};
use crate::markdown::{cells, table};
use crate::numbers::thousands;

/// A table as the text of a section.
fn text(head: &[&str], left: usize, rows: &[Vec<String>]) -> String {
    table(&cells(head), left, rows).join("\n")
}

/// Published figures of the same relations.
const PUBLISHED: [[&str; 4]; 4] = [
    ["scan matching, published", "Kümmerle et al. 2009", "0.173 ± 0.614", "1.2 ± 1.5"],
    ["RBPF, published", "Kümmerle et al. 2009", "0.060 ± 0.049", "1.2 ± 1.3"],
    ["graph mapping, published", "Kümmerle et al. 2009", "0.044 ± 0.044", "0.4 ± 0.4"],
    ["Cartographer, published", "Hess et al. 2016", "0.038 ± 0.043", "0.37 ± 0.47"],
];

/// Errors of relations, beside published ones.
pub(super) fn relations(found: &[(String, Errors)]) -> String {
    let own = |(name, errors): &(String, Errors)| {
        let [mean, deviation] = errors.rotation.map(f64::to_degrees);
        vec![
            name.clone(),
            format!("{} relations", thousands(errors.compared)),
            format!("{:.3} ± {:.3}", errors.translation[0], errors.translation[1]),
            format!("{mean:.2} ± {deviation:.2}"),
        ]
    };
    let mut rows: Vec<Vec<String>> = found.iter().map(own).collect();
    rows.extend(PUBLISHED.iter().map(|row| cells(row)));
    text(&["estimate", "source", "translation, m", "rotation, °"], 2, &rows)
}

/// What was found at each threshold, with labels by the agreed map.
pub(super) fn thresholds(log: &str, ways: &[Way], map: &Map) -> Vec<Vec<String>> {
    let row = |way: &Way| {
        let count = |accepted: Option<bool>, correct: bool| {
            let wanted =
                way.edges.iter().filter(|edge| accepted.is_none_or(|accepted| edge.accepted() == accepted));
            wanted.filter(|edge| map.correct(edge) == correct).count()
        };
        let all = way.edges.len();
        let wrong = count(None, false);
        vec![
            log.to_owned(),
            way.threshold.title(),
            all.to_string(),
            format!("{:.0} %", 100.0 * wrong as f64 / all.max(1) as f64),
            way.edges.iter().filter(|edge| edge.accepted()).count().to_string(),
            count(Some(true), false).to_string(),
            count(Some(false), true).to_string(),
            format!("{:.1}", way.seconds[0].cpu),
            format!("{:.1}", way.seconds[0].wall),
        ]
    };
    ways.iter().map(row).collect()
}

pub(super) fn thresholds_table(rows: &[Vec<String>]) -> String {
    let head = ["log", "threshold", "candidates", "wrong", "accepted", "wrong accepted", "correct rejected"];
    text(&[&head[..], &["CPU s", "seconds"]].concat(), 1, rows)
}

/// CPU and wall seconds of every program, and the log's duration.
pub(super) fn seconds(log: &str, scans: usize, duration: f64, ingest: Seconds, way: &Way) -> Vec<String> {
    let stages = [&[ingest][..], &way.seconds].concat();
    let total = stages.iter().fold(Seconds::default(), |sum, stage| sum.and(*stage));
    let mut row = vec![log.to_owned(), thousands(scans as u64), format!("{duration:.0}")];
    row.extend(stages.iter().map(|stage| format!("{:.1}", stage.cpu)));
    row.extend([
        format!("{:.1}", total.cpu),
        format!("{:.1}", total.wall),
        format!("{:.0}", duration / total.wall),
    ]);
    row
}

pub(super) fn seconds_table(rows: &[Vec<String>]) -> String {
    let stages = STAGES.map(|stage| format!("{stage}, CPU s"));
    let mut head = vec!["log", "scans", "duration, s"];
    head.extend(stages.iter().map(String::as_str));
    head.extend(["all, CPU s", "all, s", "duration / all"]);
    text(&head, 1, rows)
}

/// How well words and scans tell the same place, on the same candidates.
pub(super) fn words(log: &str, scores: &Scores) -> Vec<Vec<String>> {
    let row = |name: &str, of: &str, scored: &[Scored]| {
        let right = scored.iter().filter(|(_, right)| *right).count();
        let mut row = cells(&[log, of, name]);
        row.extend([
            scored.len().to_string(),
            format!("{:.0} %", 100.0 * right as f64 / scored.len() as f64),
        ]);
        row.extend(
            [area(scored), precision_at_full_recall(scored), recall_at_full_precision(scored)]
                .map(|value| format!("{value:.3}")),
        );
        row
    };
    vec![
        row("FAB-MAP of words", "same place", &scores.appearance),
        row("tf-idf of words", "same place", &scores.similarity),
        row("agreement beside rivals", "same place", &scores.place),
        row("agreement beside rivals", "correct measurement", &scores.correct),
    ]
}

pub(super) fn words_table(rows: &[Vec<String>]) -> String {
    let head =
        ["log", "question", "score", "candidates", "true", "area under ROC", "precision at full recall"];
    text(&[&head[..], &["recall at full precision"]].concat(), 3, rows)
}

/// Stated probabilities beside shares, for each log.
pub(super) fn calibration(logs: &[(&str, &[Scored])]) -> String {
    let all: Vec<Vec<Bin>> = logs.iter().map(|(_, scored)| bins(scored)).collect();
    let row = |at: usize| {
        let begin = if at == 0 { 0.0 } else { ENDS[at - 1] };
        let mut row = vec![format!("{begin} to {}", ENDS[at])];
        for bins in &all {
            let Bin { count, stated, found } = bins[at];
            let share = |value: f64| if count == 0 { "–".to_owned() } else { format!("{value:.3}") };
            row.extend([count.to_string(), share(stated), share(found)]);
        }
        row
    };
    let mut head = vec!["probability".to_owned()];
    for (log, _) in logs {
        head.extend([format!("{log}: candidates"), "stated".to_owned(), "true".to_owned()]);
    }
    table(&head, 1, &(0..ENDS.len()).map(row).collect::<Vec<_>>()).join("\n")
}

/// Times of the index.
pub(super) fn index(found: &[(&str, IndexTimes)]) -> String {
    let row = |(log, times): &(&str, IndexTimes)| {
        vec![
            (*log).to_owned(),
            thousands(times.keyframes),
            format!("{:.1}", times.describe),
            format!("{:.2}", times.build),
            format!("{:.2}", times.query),
            format!("{:.0}", 1e6 * times.query / times.keyframes as f64),
            format!("{:.2}", times.linear),
            format!("{:.1} %", 100.0 * times.found),
        ]
    };
    let head = [
        "log, repeated",
        "keyframes",
        "describe, s",
        "build, s",
        "all queries, s",
        "µs a query",
        "search of all, s",
    ];
    text(&[&head[..], &["found of these"]].concat(), 1, &found.iter().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_in_metres_and_degrees() {
        let errors = Errors { compared: 1278, translation: [0.0421, 0.0486], rotation: [0.00645, 0.0129] };
        let text = relations(&[("whole pipeline".to_owned(), errors)]);
        assert!(
            text.contains("| whole pipeline | 1,278 relations | 0.042 ± 0.049 | 0.37 ± 0.74 |"),
            "{text}"
        );
        assert!(
            text.contains("| graph mapping, published | Kümmerle et al. 2009 | 0.044 ± 0.044 | 0.4 ± 0.4 |"),
            "{text}"
        );
    }

    #[test]
    fn an_empty_bin_has_no_shares() {
        let scored = [(0.95, true), (0.97, false)];
        let text = calibration(&[("aces", &scored)]);
        assert!(text.contains("| 0.9 to 1 | 2 | 0.960 | 0.500 |"), "{text}");
        assert!(text.contains("| 0 to 0.01 | 0 | – | – |"), "{text}");
    }
}

//! The tables of docs/results/regimes.md.

use std::fmt::Write as _;

use super::runs::UNIFORM;
use super::table::{percent, short, signed};
use super::{Cell, Comparison, Effect, Map, Verdict};
use crate::table::{grid, metres};

/// The tables as Markdown, each with the name of its marker.
pub fn sections(map: &Map) -> Vec<(&'static str, String)> {
    vec![("verdict", verdict(map)), ("uniform", uniform(map)), ("kinds", kinds(map)), ("edges", edges(map))]
}

fn verdict(map: &Map) -> String {
    let seeds = map.maps.iter().filter(|own| map.singles().any(|single| *single == own.session));
    let counts: Vec<usize> =
        seeds.flat_map(|own| own.cells.iter().flatten().map(|cell| cell.seeds)).collect();
    let (fewest, most) = (counts.iter().min().unwrap_or(&0), counts.iter().max().unwrap_or(&0));
    let seeds = if fewest == most { fewest.to_string() } else { format!("{fewest} to {most}") };
    let mut text = format!(
        "RMSE with the graph cut minus RMSE without it, in metres; negative values favour the cut. Mean of the paired differences over {seeds} \
         seeds with its 95 % interval (percentile bootstrap). **helps** and hurts: the difference is significant in the sign-flip test at \
         0.05, adjusted over the cells of a table (Benjamini and Hochberg). Rows: share of incorrect edges; columns: scale of the \
         covariance that the odometry claims, relative to that of 0.1 m and 0.0167 rad per step; uniform mistakes.\n\n"
    );
    for session in &map.sessions {
        let made = |comparison: &&Comparison| comparison.cells.iter().any(Option::is_some);
        for comparison in map.compared(session, UNIFORM).filter(made) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{session}, {} against {}:\n", comparison.with, comparison.without);
            // A comparison may exist at some scales only.
            let known = |column: &usize| {
                (0..map.rates.len()).any(|row| comparison.cells[map.index(row, *column)].is_some())
            };
            let columns: Vec<usize> = (0..map.scales.len()).filter(known).collect();
            let mut rows = vec![vec!["incorrect edges".to_owned()]];
            rows[0]
                .extend(columns.iter().map(|&column| format!("covariance × {}", short(map.scales[column]))));
            for (row, rate) in map.rates.iter().enumerate() {
                let mut cells = vec![percent(*rate)];
                cells.extend(columns.iter().map(|&column| judged(comparison.cells[map.index(row, column)])));
                rows.push(cells);
            }
            grid(&mut text, &rows);
        }
    }
    text
}

fn judged(effect: Option<Effect>) -> String {
    let Some(effect) = effect else { return "–".to_owned() };
    let word = match effect.verdict {
        Verdict::Helps => "**helps** ",
        Verdict::Hurts => "hurts ",
        Verdict::Neutral => "",
    };
    format!("{word}{} [{}, {}]", signed(effect.difference), signed(effect.low), signed(effect.high))
}

fn uniform(map: &Map) -> String {
    let mut text = "RMSE in metres, mean over seeds with its 95 % interval.\n\n".to_owned();
    for session in &map.sessions {
        let _ = writeln!(text, "{session}:\n");
        let rows = points(map, |rate, scale| row_of_methods(map, session, UNIFORM, rate, scale, error));
        table(&mut text, map, &["covariance", "incorrect edges"], rows);
    }
    text
}

fn kinds(map: &Map) -> String {
    let mut text = "RMSE in metres, mean over seeds with its 95 % interval.\n\n".to_owned();
    for kind in &map.kinds {
        let without = |session: &&String| map.has(session, UNIFORM) && !map.has(session, kind);
        let without: Vec<&str> = map.singles().filter(without).map(String::as_str).collect();
        if !without.is_empty() {
            let _ = writeln!(
                text,
                "No {kind} mistakes on {}; means over sessions are over the others there.\n",
                without.join(", ")
            );
        }
    }
    for session in &map.sessions {
        let _ = writeln!(text, "{session}:\n");
        table(&mut text, map, &["covariance", "incorrect edges", "kind"], each_kind(map, session, error));
    }
    text
}

/// The edges, for several sessions together if there are such maps, otherwise for the only session.
fn edges(map: &Map) -> String {
    let mut text = "Precision / recall of landmark edges in use, means over seeds: edges in use that are correct / correct edges in \
                    use.\n\n"
        .to_owned();
    let share = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.3}"));
    let both = |cell: Cell| format!("{} / {}", share(cell.precision), share(cell.recall));
    let pooled: Vec<&String> =
        map.sessions.iter().filter(|name| !map.singles().any(|single| single == *name)).collect();
    let shown = if pooled.is_empty() { map.sessions.iter().collect() } else { pooled };
    for session in shown {
        let _ = writeln!(text, "{session}:\n");
        let mut rows = points(map, |rate, scale| row_of_methods(map, session, UNIFORM, rate, scale, both));
        for row in &mut rows {
            row.insert(2, UNIFORM.to_owned());
        }
        let others = each_kind(map, session, both).into_iter().filter(|row| row[2] != UNIFORM);
        rows.extend(others);
        table(&mut text, map, &["covariance", "incorrect edges", "kind"], rows);
    }
    text
}

fn error(cell: Cell) -> String {
    format!("{} [{}, {}]", metres(cell.mean), metres(cell.low), metres(cell.high))
}

fn table(text: &mut String, map: &Map, head: &[&str], rows: Vec<Vec<String>>) {
    let mut all =
        vec![head.iter().map(|name| (*name).to_owned()).chain(map.methods.iter().cloned()).collect()];
    all.extend(rows);
    grid(text, &all);
}

/// A row for each scale and rate at which a method has results.
fn points(map: &Map, cells: impl Fn(usize, usize) -> Option<Vec<String>>) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for (column, scale) in map.scales.iter().enumerate() {
        for (row, rate) in map.rates.iter().enumerate() {
            if let Some(cells) = cells(row, column) {
                rows.push([vec![format!("× {}", short(*scale)), percent(*rate)], cells].concat());
            }
        }
    }
    rows
}

/// A row for each kind, at the points where kinds other than the uniform one were swept.
fn each_kind(map: &Map, session: &str, cell: impl Fn(Cell) -> String + Copy) -> Vec<Vec<String>> {
    let others: Vec<&String> = map.kinds.iter().filter(|kind| *kind != UNIFORM).collect();
    let mut rows = Vec::new();
    for (column, scale) in map.scales.iter().enumerate() {
        for (row, rate) in map.rates.iter().enumerate() {
            let found: Vec<(&str, Vec<String>)> = others
                .iter()
                .filter_map(|kind| {
                    Some((kind.as_str(), row_of_methods(map, session, kind, row, column, cell)?))
                })
                .collect();
            if found.is_empty() {
                continue;
            }
            let first =
                row_of_methods(map, session, UNIFORM, row, column, cell).map(|cells| (UNIFORM, cells));
            for (kind, cells) in first.into_iter().chain(found) {
                rows.push(
                    [vec![format!("× {}", short(*scale)), percent(*rate), kind.to_owned()], cells].concat(),
                );
            }
        }
    }
    rows
}

/// A cell for each method; `None` if no method has results there.
fn row_of_methods(
    map: &Map,
    session: &str,
    kind: &str,
    rate: usize,
    scale: usize,
    written: impl Fn(Cell) -> String,
) -> Option<Vec<String>> {
    let cells: Vec<Option<Cell>> = map
        .methods
        .iter()
        .map(|method| map.of(session, kind, method).and_then(|own| own.cells[map.index(rate, scale)]))
        .collect();
    cells
        .iter()
        .any(Option::is_some)
        .then(|| cells.into_iter().map(|cell| cell.map_or_else(|| "–".to_owned(), &written)).collect())
}

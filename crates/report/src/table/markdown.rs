//! Tables in Markdown, for people and README files.

use std::fmt::Write as _;

use super::{Cell, Table, inline, is_silently_disconnected, listed, metres};
use posecut_stage::counted;

use crate::published::Published;

/// One section an experiment: RMSE with the published figures between the rows, then the landmark edges in use.
pub fn markdown(tables: &[Table], published: &Published) -> String {
    let mut text = String::new();
    for table in tables {
        section(&mut text, table, published);
    }
    if tables.is_empty() {
        text.push_str("There are no results.\n");
    }
    text
}

fn section(text: &mut String, table: &Table, published: &Published) {
    let seeds =
        table.methods.iter().flat_map(|row| &row.cells).flatten().map(|cell| cell.seeds).max().unwrap_or(0);
    // Writing to a string cannot fail.
    let _ = writeln!(text, "### {}\n", inline(&table.pipeline));
    let _ = writeln!(
        text,
        "RMSE in metres against the pseudo ground truth, mean ± standard deviation over {}.\n",
        counted(seeds, "seed")
    );
    let mut rows = vec![header(table)];
    for row in &table.methods {
        let mut cells = vec![row.method.clone()];
        cells.extend(row.cells.iter().map(|cell| cell.as_ref().map_or_else(|| "no data".to_owned(), rmse)));
        cells.push(row.mean().map_or_else(String::new, metres));
        rows.push(cells);
        if published.rmse.contains_key(&row.method) {
            let mut cells = vec![format!("{}, published", row.method)];
            cells.extend(
                table.sessions.iter().map(|session| {
                    published.value(&row.method, session).map_or_else(|| "–".to_owned(), metres)
                }),
            );
            cells.push(published.mean(&row.method).map_or_else(String::new, metres));
            rows.push(cells);
        }
    }
    grid(text, &rows);
    if let Some(doubts) = listed(table) {
        let _ = writeln!(text, "† doubts of stages, which docs/doubts.md explains: {}.\n", inline(&doubts));
    }
    if is_silently_disconnected(table) {
        text.push_str("† in at least one seed no edge remained between the experiences, so their relative pose is unknown.\n\n");
    }
    text.push_str(
        "Landmark edges in use: incorrect of all incorrect, correct of all correct (means over seeds).\n\n",
    );
    let mut rows = vec![header(table)];
    for row in &table.methods {
        let mut cells = vec![row.method.clone()];
        cells.extend(row.cells.iter().map(|cell| cell.as_ref().map_or_else(|| "no data".to_owned(), edges)));
        cells.push(String::new());
        rows.push(cells);
    }
    for cells in &mut rows {
        cells.pop();
    }
    grid(text, &rows);
}

fn header(table: &Table) -> Vec<String> {
    let mut cells = vec!["method".to_owned()];
    cells.extend(table.sessions.iter().cloned());
    cells.push("mean".to_owned());
    cells
}

fn rmse(cell: &Cell) -> String {
    let mark = cell.mark();
    match cell.deviation {
        Some(deviation) => format!("{} ± {}{mark}", metres(cell.mean), metres(deviation)),
        None => format!("{}{mark}", metres(cell.mean)),
    }
}

fn edges(cell: &Cell) -> String {
    format!("{:.1}/{:.1}, {:.1}/{:.1}", cell.false_kept, cell.false_all, cell.true_kept, cell.true_all)
}

/// Writes a Markdown table whose columns are aligned in plain text too.
pub(crate) fn grid(text: &mut String, rows: &[Vec<String>]) {
    let rows: Vec<Vec<String>> =
        rows.iter().map(|row| row.iter().map(|cell| inline(cell)).collect()).collect();
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    for (index, row) in rows.iter().enumerate() {
        text.push('|');
        for column in 0..columns {
            let cell = row.get(column).map_or("", String::as_str);
            let padding = width(column) - cell.chars().count();
            let _ = if column == 0 {
                write!(text, " {cell}{} |", " ".repeat(padding))
            } else {
                write!(text, " {}{cell} |", " ".repeat(padding))
            };
        }
        text.push('\n');
        if index == 0 {
            text.push('|');
            for column in 0..columns {
                let dashes = "-".repeat(width(column) + 1);
                let _ = if column == 0 { write!(text, "{dashes}-|") } else { write!(text, "{dashes}:|") };
            }
            text.push('\n');
        }
    }
    text.push('\n');
}

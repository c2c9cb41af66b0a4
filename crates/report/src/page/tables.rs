//! The tables of the page as HTML, so that they are visible without scripts.

use std::fmt::Write as _;

use posecut_view::markup::escape;

use crate::published::Published;
use crate::table::{Cell, Table, is_silently_disconnected, listed, metres};

/// A table of RMSE by method and session, with published figures below the rows that they belong to, and a table of the
/// landmark edges in use.
pub fn experiment(table: &Table, published: &Published) -> String {
    let seeds =
        table.methods.iter().flat_map(|row| &row.cells).flatten().map(|cell| cell.seeds).max().unwrap_or(0);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "<div><h3>{}</h3>", escape(&table.pipeline));
    let _ = writeln!(
        text,
        "<p class=\"note\">RMSE in metres against the pseudo ground truth: mean ± standard deviation over {}.</p>",
        posecut_stage::counted(seeds, "seed")
    );
    let _ = writeln!(
        text,
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"RMSE, {}\"><table>",
        escape(&table.pipeline)
    );
    heading(&mut text, table, true);
    for row in &table.methods {
        let _ = write!(text, "<tr><th scope=\"row\">{}</th>", escape(&row.method));
        for cell in &row.cells {
            text.push_str(&rmse(cell.as_ref()));
        }
        let _ =
            writeln!(text, "<td class=\"mean\">{}</td></tr>", row.mean().map_or_else(String::new, metres));
        if published.rmse.contains_key(&row.method) {
            let _ = write!(
                text,
                "<tr class=\"published\"><th scope=\"row\">{}, published</th>",
                escape(&row.method)
            );
            for session in &table.sessions {
                let value = published.value(&row.method, session).map_or_else(|| "–".to_owned(), metres);
                let _ = write!(text, "<td>{value}</td>");
            }
            let mean = published.mean(&row.method).map_or_else(String::new, metres);
            let _ = writeln!(text, "<td class=\"mean\">{mean}</td></tr>");
        }
    }
    text.push_str("</tbody></table></div>\n");
    if let Some(doubts) = listed(table) {
        let _ = writeln!(
            text,
            "<p class=\"note\">† Doubts of stages, which docs/doubts.md explains: {}.</p>",
            escape(&doubts)
        );
    }
    if is_silently_disconnected(table) {
        text.push_str("<p class=\"note\">† In at least one seed no edge remained between the experiences, so their relative pose is unknown.</p>\n");
    }
    edges(&mut text, table);
    text.push_str("</div>\n");
    text
}

fn edges(text: &mut String, table: &Table) {
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "<details><summary>Landmark edges in use, {0}</summary><p class=\"note\">Incorrect edges in use of all incorrect, correct edges in use of all correct: means over seeds.</p><div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"Landmark edges in use, {0}\"><table>",
        escape(&table.pipeline)
    );
    heading(text, table, false);
    for row in &table.methods {
        let _ = write!(text, "<tr><th scope=\"row\">{}</th>", escape(&row.method));
        for cell in &row.cells {
            let cell = cell.as_ref().map_or_else(
                || "no data".to_owned(),
                |cell| {
                    format!(
                        "<span class=\"{}\">{:.1}</span>/{:.1}, {:.1}/{:.1}",
                        if cell.false_kept > 0.0 { "bad" } else { "good" },
                        cell.false_kept,
                        cell.false_all,
                        cell.true_kept,
                        cell.true_all
                    )
                },
            );
            let _ = write!(text, "<td>{cell}</td>");
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</tbody></table></div></details>\n");
}

fn heading(text: &mut String, table: &Table, mean: bool) {
    text.push_str("<thead><tr><th scope=\"col\">method</th>");
    for session in &table.sessions {
        let _ = write!(text, "<th scope=\"col\">{}</th>", escape(session));
    }
    if mean {
        text.push_str("<th scope=\"col\">mean</th>");
    }
    text.push_str("</tr></thead><tbody>\n");
}

fn rmse(cell: Option<&Cell>) -> String {
    let Some(cell) = cell else { return "<td class=\"absent\">no data</td>".to_owned() };
    let mark = cell.mark();
    match cell.deviation {
        Some(deviation) => format!(
            "<td>{} <span class=\"spread\">± {}</span>{mark}</td>",
            metres(cell.mean),
            metres(deviation)
        ),
        None => format!("<td>{}{mark}</td>", metres(cell.mean)),
    }
}

//! The tables of the trust benchmark as HTML, so that they are visible without scripts.

use std::fmt::Write as _;

use posecut_view::markup::escape;

use crate::trust::tables::Table;

/// The tables as HTML: the first open, the others folded.
pub fn html(tables: &[Table]) -> String {
    let mut text = String::new();
    for (index, table) in tables.iter().enumerate() {
        let title = escape(&table.title);
        // Writing to a string cannot fail.
        let _ = if index == 0 {
            writeln!(text, "<h3>{title}</h3>")
        } else {
            writeln!(text, "<details><summary>{title}</summary>")
        };
        if !table.note.is_empty() {
            let _ = writeln!(text, "<p class=\"note\">{}</p>", emphasised(&table.note));
        }
        if table.cells.len() > 1 {
            rows(&mut text, &title, &table.cells);
        }
        if index > 0 {
            text.push_str("</details>\n");
        }
    }
    text
}

fn rows(text: &mut String, title: &str, cells: &[Vec<String>]) {
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{title}\"><table><thead><tr>"
    );
    for name in &cells[0] {
        let _ = write!(text, "<th scope=\"col\">{}</th>", escape(name));
    }
    text.push_str("</tr></thead><tbody>\n");
    for row in &cells[1..] {
        for (column, cell) in row.iter().enumerate() {
            let cell = escape(cell);
            let _ = match column {
                0 => write!(text, "<tr><th scope=\"row\">{cell}</th>"),
                _ => write!(text, "<td>{cell}</td>"),
            };
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</tbody></table></div>\n");
}

/// A note as HTML: `*words*` are emphasised, as in Markdown.
fn emphasised(note: &str) -> String {
    let escaped = escape(note);
    let mut parts = escaped.split('*');
    let mut text = parts.next().unwrap_or_default().to_owned();
    for (index, part) in parts.enumerate() {
        text.push_str(if index % 2 == 0 { "<em>" } else { "</em>" });
        text.push_str(part);
    }
    text
}

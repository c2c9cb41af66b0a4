//! Tables in LaTeX, for papers.

use std::fmt::Write as _;

use super::{Cell, Table, listed, metres};
use crate::published::Published;

/// One `tabular` an experiment; needs no package.
pub fn latex(tables: &[Table], published: &Published) -> String {
    let mut text = String::new();
    for table in tables {
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "% {}: RMSE in metres, mean and standard deviation over seeds",
            escape(&table.pipeline)
        );
        let _ = writeln!(text, "\\begin{{tabular}}{{l{}}}", "r".repeat(table.sessions.len() + 1));
        let _ = writeln!(text, "\\hline");
        let sessions: Vec<String> = table.sessions.iter().map(|session| escape(session)).collect();
        let _ = writeln!(text, " & {} & mean \\\\", sessions.join(" & "));
        let _ = writeln!(text, "\\hline");
        for row in &table.methods {
            let cells: Vec<String> = row
                .cells
                .iter()
                .map(|cell| match cell {
                    None => "--".to_owned(),
                    Some(cell) => value(cell),
                })
                .collect();
            let mean = row.mean().map_or_else(String::new, metres);
            let _ = writeln!(text, "{} & {} & {mean} \\\\", escape(&row.method), cells.join(" & "));
            if published.rmse.contains_key(&row.method) {
                let cells: Vec<String> = table
                    .sessions
                    .iter()
                    .map(|session| {
                        published.value(&row.method, session).map_or_else(|| "--".to_owned(), metres)
                    })
                    .collect();
                let mean = published.mean(&row.method).map_or_else(String::new, metres);
                let _ = writeln!(
                    text,
                    "{} (published) & {} & {mean} \\\\",
                    escape(&row.method),
                    cells.join(" & ")
                );
            }
        }
        let _ = writeln!(text, "\\hline");
        let _ = writeln!(text, "\\end{{tabular}}\n");
        note(&mut text, table);
    }
    text
}

fn value(cell: &Cell) -> String {
    let mark = if cell.doubts.is_empty() { "" } else { "^\\dagger" };
    match cell.deviation {
        Some(deviation) => format!("${} \\pm {}{mark}$", metres(cell.mean), metres(deviation)),
        None if mark.is_empty() => metres(cell.mean),
        None => format!("${}{mark}$", metres(cell.mean)),
    }
}

/// The meaning of the daggers.
fn note(text: &mut String, table: &Table) {
    if let Some(doubts) = listed(table) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "$\\dagger$ doubts of stages: {}.\n", escape(&doubts));
    }
}

/// Escapes characters that are special in LaTeX.
fn escape(text: &str) -> String {
    text.chars()
        .map(|character| match character {
            '&' | '%' | '$' | '#' | '_' | '{' | '}' => format!("\\{character}"),
            '\\' => "\\textbackslash{}".to_owned(),
            '~' => "\\textasciitilde{}".to_owned(),
            '^' => "\\textasciicircum{}".to_owned(),
            // A line break would end a comment.
            other if other.is_control() => " ".to_owned(),
            other => other.to_string(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn special_characters_are_escaped() {
        assert_eq!(escape("a_b & 5 %"), "a\\_b \\& 5 \\%");
        assert_eq!(escape("a\n\\input{x}"), "a \\textbackslash{}input\\{x\\}");
    }
}

//! A report as JUnit XML, which CI services show.

use std::fmt::Write as _;

use crate::check::Report;

/// Writes one test case for each row; its class is `EXPERIMENT.STAGE`.
pub fn junit(report: &Report) -> String {
    let failed = report.rows.iter().filter(|row| !row.failures.is_empty()).count();
    let mut text = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "<testsuites>\n<testsuite name=\"posecut results\" tests=\"{}\" failures=\"{failed}\" skipped=\"0\">",
        report.rows.len()
    );
    for row in &report.rows {
        let experiment = row.name.split(['/', ':']).next().unwrap_or_default();
        let _ = write!(
            text,
            "<testcase classname=\"{}.{}\" name=\"{}\">",
            escaped(experiment),
            escaped(&row.stage),
            escaped(&row.name)
        );
        if !row.failures.is_empty() {
            let _ = write!(
                text,
                "<failure message=\"{}\">{}</failure>",
                escaped(&row.failures[0]),
                escaped(&row.failures.join("\n"))
            );
        }
        if !row.notes.is_empty() {
            let _ = write!(text, "<system-out>{}</system-out>", escaped(&row.notes.join("\n")));
        }
        text.push_str("</testcase>\n");
    }
    text.push_str("</testsuite>\n</testsuites>\n");
    text
}

fn escaped(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut escaped, character| {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push_str("&#10;"),
            // XML 1.0 forbids all other control characters.
            character if character.is_control() => escaped.push('\u{fffd}'),
            character => escaped.push(character),
        }
        escaped
    })
}

//! The numbers of maps of laser logs as HTML tables, so that they are visible without scripts.

use std::fmt::Write as _;

use posecut_view::markup::escape;

use super::errors::Spread;
use super::{LogMap, LogMaps};

/// Candidates and errors of each log, and sentences that say how to make what a log does not have.
pub fn table(maps: &[LogMaps]) -> String {
    if maps.is_empty() {
        return String::new();
    }
    let mut text = "<div class=\"tables\">\n".to_owned();
    let labelled = maps.iter().any(|log| log.candidates.counts.accepted_incorrect.is_some());
    let mut columns = vec!["log", "candidates", "accepted", "rejected", "undecided"];
    columns.extend(labelled.then_some("accepted, but incorrect"));
    rows(&mut text, "Candidates", &columns, maps.iter().map(|log| (log, counts(log, labelled))));
    let columns = ["log", "relations", "before", "all candidates in use", "after"];
    let measured: Vec<_> = maps.iter().filter_map(|log| Some((log, errors(log)?))).collect();
    if !measured.is_empty() {
        rows(&mut text, "Errors of relative motions", &columns, measured.into_iter());
    }
    text.push_str("</div>\n");
    for sentence in sentences(maps) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "<p class=\"note\">{}</p>", escape(&sentence));
    }
    text
}

/// A table with a row for each log, whose cells are HTML.
fn rows<'a>(
    text: &mut String,
    title: &str,
    columns: &[&str],
    rows: impl Iterator<Item = (&'a LogMaps, Vec<String>)>,
) {
    let _ = write!(
        text,
        "<div><h3>{title}</h3><div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{title} of laser logs\"><table><thead><tr>"
    );
    for column in columns {
        let _ = write!(text, "<th scope=\"col\">{column}</th>");
    }
    text.push_str("</tr></thead><tbody>\n");
    for (log, cells) in rows {
        let _ = write!(text, "<tr><th scope=\"row\">{}</th>", escape(&log.name));
        for cell in cells {
            let _ = write!(text, "<td>{cell}</td>");
        }
        text.push_str("</tr>\n");
    }
    text.push_str("</tbody></table></div></div>\n");
}

fn counts(log: &LogMaps, labelled: bool) -> Vec<String> {
    let counts = &log.candidates.counts;
    let mut cells = [counts.candidates, counts.accepted, counts.rejected, counts.undecided]
        .map(|count| count.to_string())
        .to_vec();
    if labelled {
        cells.push(match counts.accepted_incorrect {
            None => "<span class=\"absent\">unknown</span>".to_owned(),
            Some(0) => "<span class=\"good\">0</span>".to_owned(),
            Some(count) => format!("<span class=\"bad\">{count}</span>"),
        });
    }
    cells
}

/// Relations, and the errors of the three maps; `None` if none of them was compared.
fn errors(log: &LogMaps) -> Option<Vec<String>> {
    let views = [Some(&log.before), log.all_candidates.as_ref(), Some(&log.after)];
    let compared = views.iter().find_map(|view| (*view)?.errors)?.compared;
    let cells = views.map(|view| view.and_then(error).unwrap_or_else(|| "–".to_owned()));
    Some([vec![compared.to_string()], cells.to_vec()].concat())
}

/// The errors of a map, metres and degrees.
fn error(map: &LogMap) -> Option<String> {
    let errors = map.errors?;
    let spread = |spread: Spread, factor: f64, digits: usize| {
        format!("{:.digits$} ± {:.digits$}", spread.mean * factor, spread.std * factor)
    };
    let turn = spread(errors.rotation_rad?, 1.0_f64.to_degrees(), 2);
    Some(format!("{} m, {turn}°", spread(errors.translation_m?, 1.0, 3)))
}

fn sentences(maps: &[LogMaps]) -> impl Iterator<Item = String> {
    let names = |wanted: fn(&LogMaps) -> bool| {
        let names: Vec<&str> = maps.iter().filter(|log| wanted(log)).map(|log| log.name.as_str()).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    [
        maps.iter().any(|log| errors(log).is_some()).then(|| {
            "Errors: mean ± standard deviation over measured relations between two times, of translation and rotation.".to_owned()
        }),
        names(|log| errors(log).is_none()).map(|names| {
            format!("The errors of {names} are unknown: make map LOG=FILE RELATIONS=FILE compares a map with measured relations.")
        }),
        names(|log| log.candidates.counts.candidates == 0).map(|names| {
            format!("There are no candidates in {names}: make map finds them unless it is given RECOGNIZE=cat.")
        }),
        names(|log| log.candidates.counts.candidates > 0 && log.all_candidates.is_none()).map(|names| {
            format!("There is no map of {names} with all candidates in use (all-candidates.jsonl): make map writes it unless it is given VERIFY=cat.")
        }),
    ]
    .into_iter()
    .flatten()
}

//! The sections of docs/trust.md, and of other pages of its form.

use super::benchmark::Benchmark;
use super::comparison::comparison;
use super::joined::joined;
use super::misses::misses;
use super::recommendation::{answer, recommended};
use super::records::Half;
use super::reliability::{reliability, sentence};
use super::tables::{self, Table};

/// The sections as Markdown, each with the name of its marker. `diagram` is the link from the document to the diagram of probabilities.
///
/// # Errors
/// If no method can be recommended.
pub fn sections(benchmark: &Benchmark, diagram: Option<&str>) -> anyhow::Result<Vec<(&'static str, String)>> {
    let half = Half::Test;
    let all = |tables: Vec<Table>| -> String { tables.iter().map(Table::markdown).collect() };
    Ok(vec![
        ("answer", answer(benchmark)?),
        ("comparison", all(vec![comparison(benchmark, half, recommended(benchmark)?)])),
        ("misses", all(vec![misses(benchmark, half, recommended(benchmark)?)])),
        ("joined", joined_parts(benchmark, half)),
        ("overall", all(vec![tables::overall(benchmark, half), tables::matrix(benchmark, half)])),
        ("counts", all(vec![tables::counts(benchmark)])),
        ("families", all(tables::families(benchmark, half))),
        ("reliability", calibration(benchmark, half, diagram)),
        (
            "failures",
            all(std::iter::once(tables::failures(benchmark, half))
                .chain(tables::doubts(benchmark, half))
                .collect()),
        ),
        ("tuning", all(vec![tables::overall(benchmark, Half::Tuning)])),
        (
            "time",
            tables::time(benchmark, half)
                .map_or_else(|| "No CPU times were given (`--times`).".to_owned(), |table| table.markdown()),
        ),
    ])
}

/// The distance of what is joined from the ground truth, on both halves. The first table explains both.
fn joined_parts(benchmark: &Benchmark, half: Half) -> String {
    let tuning = joined(benchmark, Half::Tuning).map(|table| Table { note: String::new(), ..table });
    let text: String =
        joined(benchmark, half).into_iter().chain(tuning).map(|table| table.markdown()).collect();
    if text.is_empty() {
        "No result has this distance (`ground_truth`, `joined_rmse`).".to_owned()
    } else {
        text
    }
}

/// The calibration of probabilities: the answer, the figure and the tables.
fn calibration(benchmark: &Benchmark, half: Half, diagram: Option<&str>) -> String {
    let found = reliability(benchmark, half);
    let mut text = sentence(found.as_ref(), half);
    if let Some(tuning) = reliability(benchmark, Half::Tuning) {
        text += &format!(" {}", sentence(Some(&tuning), Half::Tuning));
    }
    if let Some(found) = &found {
        text.push_str("\n\n");
        if let Some(link) = diagram {
            text += &format!("![Share of correct edges over their probability, by family]({link})\n\n");
        }
        for table in tables::calibration(found) {
            text.push_str(&table.markdown());
        }
    }
    text
}

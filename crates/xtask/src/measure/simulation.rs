//! Simulated sessions beside real NCLT sessions, statistic by statistic, for crates/simulate/README.md.

mod odometry;
mod plane;
mod series;
mod session;

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use xtask::sections::replace;
use xtask::workspace::root;

use crate::Verdict;
use session::statistics;

/// Compare simulated sessions with real NCLT sessions, statistic by statistic
///
/// Each directory contains one directory per session, named by its date, with the CSV files of NCLT. Prints a Markdown table: real
/// sessions on the left, simulated ones on the right, `–` if a session lacks the file.
///
/// The figures are computed in the same way on both sides:
///
/// - Everything is planar: x north, y east, heading. Rows with NaN and rows whose time does not advance are left out.
///
/// - Sessions come at different rates (here 1 to 10 Hz), so all series are first interpolated at common times: every second for
///   lengths, every two seconds (the paper's keyframes) for the rest. Nothing is interpolated across a silence of more than 5 s.
///
/// - Moving means at least 0.15 m/s over two seconds.
///
/// - Turning is the sum of the changes of the direction of travel between points 5 m apart along the path.
///
/// - A step error is the odometry's motion over two seconds against the true motion, as SE(2) logarithm; its spread is the robust
///   standard deviation, 1.4826 times the median of the absolute values.
///
/// - The end drift is the distance at the end after the best rigid alignment of the first 200 m; the ATE is the root mean square
///   distance after the best rigid alignment of everything.
///
/// - Landmark edges are pairs of keyframes, one in each half of the session, within 3 m and 30 degrees of heading.
#[derive(Args)]
pub(crate) struct Simulation {
    nclt: PathBuf,
    simulated: PathBuf,
    /// Write the table into crates/simulate/README.md
    #[arg(long)]
    write: bool,
}

/// The statistics of one session: pairs of row name and value.
type Statistics = Vec<(String, String)>;

/// The rows that come last, by the first words of their names.
const GROUPS: [&str; 4] = ["odometry_mu_100hz", "wheels", "wheels'", "ms25_euler"];

impl Simulation {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let mut columns = Vec::new();
        for (title, directory) in [("real", &self.nclt), ("sim.", &self.simulated)] {
            let found = sessions(directory)?;
            columns.extend(found.into_iter().map(|(name, values)| (format!("{title} {name}"), values)));
        }
        let text = table(&columns);
        print!("{text}");
        if self.write {
            replace(&root().join("crates/simulate/README.md"), "comparison", &text)?;
        }
        Ok(Verdict::Holds)
    }
}

/// The statistics of all sessions below a directory, in the order of their names.
fn sessions(directory: &Path) -> anyhow::Result<Vec<(String, Statistics)>> {
    if !directory.is_dir() {
        bail!(
            "{}: is not a directory; name the one that contains a directory for each session",
            directory.display()
        );
    }
    let mut folders = Vec::new();
    for entry in directory.read_dir().with_context(|| directory.display().to_string())? {
        folders.push(entry?.path());
    }
    folders.sort();
    let mut found = Vec::new();
    for folder in folders.iter().filter(|path| path.is_dir()) {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match statistics(folder, &name)? {
            Some(values) => found.push((name, values)),
            None => eprintln!(
                "{}: skipped, because groundtruth_{name}.csv is missing or unusable",
                folder.display()
            ),
        }
    }
    if found.is_empty() {
        bail!("{}: contains no session with ground truth", directory.display());
    }
    Ok(found)
}

/// Rows are grouped by their first word, because some sessions lack rows that others have.
fn table(columns: &[(String, Statistics)]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in columns.iter().flat_map(|(_, values)| values) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let group = |name: &&str| {
        let first = name.split(' ').next().unwrap_or_default().trim_end_matches(':');
        GROUPS.iter().position(|word| *word == first).map_or(0, |place| place + 1)
    };
    names.sort_by_key(group);
    let head = ["statistic"].into_iter().chain(columns.iter().map(|(title, _)| title.as_str())).collect();
    let row = |name: &&'_ str| {
        let value = |values: &'_ Statistics| {
            values.iter().find(|(own, _)| own == name).map(|(_, value)| value.clone())
        };
        let cells = columns.iter().map(|(_, values)| value(values).unwrap_or_else(|| "–".to_owned()));
        [(*name).to_owned()].into_iter().chain(cells).collect::<Vec<String>>()
    };
    aligned(head, &names.iter().map(row).collect::<Vec<_>>())
}

/// A table whose columns are as wide as their widest cell: the first aligned left, all others aligned right.
fn aligned(head: Vec<&str>, rows: &[Vec<String>]) -> String {
    let head: Vec<String> = head.into_iter().map(str::to_owned).collect();
    let all = || std::iter::once(&head).chain(rows);
    let width = |column: usize| all().map(|row| row[column].chars().count()).max().unwrap_or_default();
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let mut text = String::new();
    for (number, row) in all().enumerate() {
        text += &format!("| {:<1$} |", row[0], widths[0]);
        for (cell, width) in row.iter().zip(&widths).skip(1) {
            text += &format!(" {cell:>width$} |");
        }
        text.push('\n');
        if number == 0 {
            text += &format!("|{}|", "-".repeat(widths[0] + 2));
            for width in &widths[1..] {
                text += &format!("{}:|", "-".repeat(width + 1));
            }
            text.push('\n');
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_grouped_by_their_sensors() {
        let of = |values: &[(&str, &str)]| -> Statistics {
            values.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect()
        };
        let columns = [
            ("real a".to_owned(), of(&[("length (m)", "9"), ("ms25_euler error", "1")])),
            ("sim. b".to_owned(), of(&[("length (m)", "10"), ("odometry_mu_100hz: drift", "2")])),
        ];
        assert_eq!(
            table(&columns),
            "| statistic                | real a | sim. b |\n\
             |--------------------------|-------:|-------:|\n\
             | length (m)               |      9 |     10 |\n\
             | odometry_mu_100hz: drift |      – |      2 |\n\
             | ms25_euler error         |      1 |      – |\n"
        );
    }
}

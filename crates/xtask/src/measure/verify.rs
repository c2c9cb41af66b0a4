//! Measures posecut-verify beside posecut-pcm: time and memory of whole processes, for docs/results/verify-speed.md.

mod graphs;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use anyhow::bail;
use clap::Args;
use xtask::sections::{replace, rows};
use xtask::workspace::{programs_folder, root};

use crate::Verdict;
use crate::machine::{Machine, today};
use crate::markdown;
use crate::numbers::{general, median};
use crate::process::{Ended, measure, shown};
use graphs::{FIVE_SESSIONS, graphs};

/// Measure posecut-verify and posecut-pcm: seconds and memory of whole processes
///
/// Regenerates the section `speed` of docs/results/verify-speed.md. You can measure single sizes: the rows of other sizes stay.
/// Needs the release programs and `cargo build --release -p posecut-pcm --example draw`.
#[derive(Args)]
pub(crate) struct Verify {
    /// Measure with these numbers of candidates; 41142 is five whole NCLT sessions and needs their data
    #[arg(long, num_args = 1.., default_values_t = GOALS.map(|(size, _)| size))]
    sizes: Vec<u64>,
    /// Run each process this many times; the table shows medians
    #[arg(long, default_value_t = 5)]
    repeats: usize,
    /// Stop a process after this many seconds
    #[arg(long, default_value_t = 120.0)]
    limit: f64,
    /// Read NCLT sessions from this directory [default: nclt/ in $POSECUT_SHARED_DATA or ../shared/data]
    #[arg(long)]
    nclt: Option<PathBuf>,
    /// Write into the section `speed` of this document [default: docs/results/verify-speed.md]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

const SECTION: &str = "speed";
/// The goals: wall seconds of posecut-verify by number of candidates.
const GOALS: [(u64, f64); 4] = [(1000, 0.05), (5000, 0.5), (FIVE_SESSIONS, 8.0), (100_000, 15.0)];
/// The first method is compared with the others.
const METHODS: [(&str, &str, &[&str]); 3] = [
    ("verify", "posecut-verify", &[]),
    ("pcm", "posecut-pcm", &[]),
    ("pcm --chance 3", "posecut-pcm", &["--chance", "3"]),
];

/// Medians of a method over its repeats.
#[derive(Clone, Copy)]
struct Medians {
    wall: f64,
    cpu: f64,
    megabytes: f64,
}

impl Verify {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let document = self.output.clone().unwrap_or_else(|| root().join("docs/results/verify-speed.md"));
        let nclt = self.nclt.clone().unwrap_or_else(|| {
            let data = std::env::var_os("POSECUT_SHARED_DATA").map(PathBuf::from);
            data.unwrap_or_else(|| root().join("../shared/data")).join("nclt")
        });
        let size = |cells: &[String]| cells[0].parse::<u64>().ok();
        let mut table = rows(&document, SECTION)?;
        table.retain(|cells| size(cells).is_some_and(|size| !self.sizes.contains(&size)));
        let folder = tempfile::tempdir()?;
        for wanted in &self.sizes {
            for (title, path) in graphs(*wanted, &nclt, folder.path())? {
                let row = self.cells(*wanted, &title, &self.measured(&path)?, &load(), &today()?);
                eprintln!("{}", markdown::row(&row));
                table.push(row);
            }
        }
        // The sort is stable: rows of the same size keep their order.
        table.sort_by_key(|cells| size(cells));
        let machine = Machine::here();
        let intro =
            format!("Measured on {} cores, {:.0} GB, {}.\n", machine.cores, machine.gigabytes, machine.model);
        let lines = [vec![intro], markdown::table(&head(), 0, &table)].concat();
        replace(&document, SECTION, &lines.join("\n"))?;
        Ok(Verdict::Holds)
    }

    /// Measures every method on a graph; `None` for a method if one of its runs was stopped.
    fn measured(&self, graph: &Path) -> anyhow::Result<Vec<Option<Medians>>> {
        let limit = Duration::try_from_secs_f64(self.limit)?;
        let mut found = METHODS.map(|_| Some(Vec::new()));
        // Methods take turns, so that other load on the machine affects all of them alike.
        for _ in 0..self.repeats {
            for ((_, program, options), found) in METHODS.iter().zip(&mut found) {
                let Some(runs) = found else { continue };
                let mut command = Command::new(programs_folder().join(program));
                command.arg("-q").arg(graph).args(*options).args(["-o", "/dev/null"]);
                match measure(&mut command, limit)? {
                    Ended::Done(run) => runs.push(run),
                    Ended::OutOfTime => *found = None,
                    Ended::Failed(said) => bail!("{}: {said}", shown(&command)),
                }
            }
        }
        let medians = |runs: &Vec<crate::process::Measured>| {
            let of = |figure: fn(&crate::process::Measured) -> f64| {
                median(&runs.iter().map(figure).collect::<Vec<_>>())
            };
            let megabytes = of(|run| run.peak as f64 / f64::from(1 << 20));
            Medians { wall: of(|run| run.wall), cpu: of(|run| run.cpu), megabytes }
        };
        Ok(found.iter().map(|runs| runs.as_ref().map(medians)).collect())
    }

    fn cells(
        &self,
        size: u64,
        graph: &str,
        found: &[Option<Medians>],
        load: &str,
        date: &str,
    ) -> Vec<String> {
        let seconds = |value: Option<f64>| match value {
            None => format!("> {:.0}", self.limit),
            Some(value) if value < 10.0 => format!("{value:.3}"),
            Some(value) => format!("{value:.1}"),
        };
        let nothing = || "–".to_owned();
        let own = found[0];
        let mut cells = vec![size.to_string(), graph.to_owned()];
        cells.extend(found.iter().map(|run| seconds(run.map(|run| run.wall))));
        cells.extend(found.iter().map(|run| seconds(run.map(|run| run.cpu))));
        let ratio = |other: &Option<Medians>| Some(format!("{:.1}", own?.cpu / other.as_ref()?.cpu));
        cells.extend(found[1..].iter().map(|other| ratio(other).unwrap_or_else(nothing)));
        match GOALS.iter().find(|(goal, _)| *goal == size) {
            None => cells.extend([nothing(), nothing()]),
            Some((_, goal)) => {
                let reached = own.is_some_and(|own| own.wall <= *goal);
                cells.extend([general(*goal, 6), if reached { "yes" } else { "no" }.to_owned()]);
            }
        }
        cells.push(own.map_or_else(nothing, |own| format!("{:.0}", own.megabytes)));
        cells.extend([self.repeats.to_string(), load.to_owned(), date.to_owned()]);
        cells
    }
}

fn head() -> Vec<String> {
    let names = || METHODS.iter().map(|(name, ..)| name);
    let mut head = markdown::cells(&["candidates", "graph"]);
    head.extend(names().map(|name| format!("{name}, s")));
    head.extend(names().map(|name| format!("{name}, CPU s")));
    head.extend(names().skip(1).map(|name| format!("verify / {name}")));
    head.extend(markdown::cells(&["goal, s", "reached", "verify, MB", "repeats", "load", "date"]));
    head
}

/// The load of the machine: runnable processes, mean over the last minute.
fn load() -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let first = text.split(' ').next().and_then(|word| word.parse::<f64>().ok());
    first.map_or_else(|| "–".to_owned(), |load| format!("{load:.0}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_that_was_stopped_has_no_ratio() {
        let task = Verify { sizes: Vec::new(), repeats: 3, limit: 120.0, nclt: None, output: None };
        let own = Medians { wall: 0.0441, cpu: 0.06, megabytes: 12.4 };
        let other = Medians { wall: 12.34, cpu: 0.012, megabytes: 3.0 };
        let cells = task.cells(1000, "drawn", &[Some(own), Some(other), None], "2", "2026-11-21");
        assert_eq!(
            markdown::row(&cells),
            "| 1000 | drawn | 0.044 | 12.3 | > 120 | 0.060 | 0.012 | > 120 | 5.0 | – | 0.05 | yes | 12 | 3 | 2 | 2026-11-21 |"
        );
        assert_eq!(cells.len(), head().len());
    }
}

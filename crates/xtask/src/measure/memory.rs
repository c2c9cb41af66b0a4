//! Measures peak memory and time of every program, for docs/results/memory.md and READMEs.

pub(super) mod graph;
mod inputs;

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use anyhow::{Context as _, bail};
use clap::Args;
use clap::builder::PossibleValuesParser;
use xtask::sections::{replace, rows};
use xtask::workspace::{program, root};

use crate::Verdict;
use crate::machine::{Machine, today};
use crate::markdown;
use crate::process::{Ended, Measured, measure_accepting, shown};
use inputs::{Inputs, Kind};

/// Measure peak memory and seconds of every program on the largest sensible input
///
/// Regenerates the table of docs/results/memory.md and the lines in READMEs. The rows of programs that are not measured stay.
/// Needs the release programs.
#[derive(Args)]
pub(crate) struct Memory {
    /// Measure a tenth of each input, and fail if memory exceeds twice the prediction of the table; write nothing
    #[arg(long, conflicts_with = "only")]
    check: bool,
    /// Measure only these programs
    #[arg(long, num_args = 1.., value_parser = PossibleValuesParser::new(CASES.map(|case| case.program)))]
    only: Vec<String>,
}

const PAGE: &str = "docs/results/memory.md";
const SECTION: &str = "memory";
const MEBIBYTE: f64 = (1 << 20) as f64;
/// Memory of a process before it reads any input, with its threads and buffers.
const BASE: f64 = 16.0 * MEBIBYTE;
const MARGIN: f64 = 2.0;
/// A program that runs longer than this has run away; no measurement takes as long.
const LIMIT: Duration = Duration::from_mins(10);

struct Case {
    program: &'static str,
    options: &'static [&'static str],
    kind: Kind,
    size: usize,
}

const fn case(program: &'static str, options: &'static [&'static str], kind: Kind, size: usize) -> Case {
    Case { program, options, kind, size }
}

/// The largest sensible graph has a million nodes. Methods that take minutes on it get a smaller one.
const CASES: [Case; 19] = [
    case("simulate", &["--rate", "40", "--overwrite"], Kind::Metres, 100_000),
    case("ingest", &[], Kind::Session, 100_000),
    case("construct", &["--radius", "3", "--incorrect-rate", "0.2"], Kind::SessionGraph, 100_000),
    case("convert", &["--to", "g2o"], Kind::Graph, 1_000_000),
    case("label", &[], Kind::Graph, 1_000_000),
    case("oracle", &[], Kind::Graph, 1_000_000),
    case("inspect", &["info"], Kind::Graph, 1_000_000),
    case("islands", &[], Kind::Graph, 1_000_000),
    case("pcm", &[], Kind::Graph, 1_000_000),
    case("verify", &[], Kind::Graph, 100_000),
    case("ransac", &[], Kind::Graph, 1_000_000),
    case("multicut", &[], Kind::Graph, 1_000_000),
    case("optimize", &[], Kind::CleanGraph, 1_000_000),
    case("evaluate", &[], Kind::Graph, 1_000_000),
    case("densest", &[], Kind::Graph, 20_000),
    case("voting", &[], Kind::Graph, 20_000),
    case("report", &["table"], Kind::Results, 100_000),
    case("experiment", &["plan"], Kind::Seeds, 20_000),
    case("conform", &["--"], Kind::Program, 1),
];

impl Memory {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let folder = tempfile::tempdir()?;
        let inputs = Inputs::new(folder.path());
        if self.check {
            return check(&inputs);
        }
        record(&self.only, &inputs)?;
        Ok(Verdict::Holds)
    }
}

/// Runs a process that must end with status 0 or 1 within the limit.
fn run(command: &mut Command) -> anyhow::Result<Measured> {
    match measure_accepting(command, LIMIT, &[0, 1])? {
        Ended::Done(measured) => Ok(measured),
        Ended::Failed(said) => bail!("{}: {said}", shown(command)),
        Ended::OutOfTime => {
            bail!("{}: took more than {} s; measure a smaller input", shown(command), LIMIT.as_secs())
        }
    }
}

/// Measures a case on a share of its input, and returns the number of bytes read too.
fn measured(case: &Case, inputs: &Inputs, share: usize) -> anyhow::Result<(Measured, u64)> {
    let (given, read) = inputs.arguments(case.kind, (case.size / share).max(1))?;
    let mut command = Command::new(program(case.program));
    if case.program != "conform" {
        command.args(["--threads", "2"]);
    }
    Ok((run(command.args(case.options).args(given))?, read))
}

/// The rows of the document, each with the name of its program.
fn known(page: &Path) -> anyhow::Result<Vec<(String, Vec<String>)>> {
    let named = |cells: Vec<String>| Some((cells.first()?.strip_prefix("posecut-")?.to_owned(), cells));
    Ok(rows(page, SECTION)?.into_iter().filter_map(named).collect())
}

/// Checks that memory on a tenth of the input is within the bound stated in the document.
fn check(inputs: &Inputs) -> anyhow::Result<Verdict> {
    let known = known(&root().join(PAGE))?;
    let mut wrong = Vec::new();
    for case in &CASES {
        let (found, _) = measured(case, inputs, 10)?;
        let row = known.iter().find(|(name, _)| name == case.program);
        let each = row.and_then(|(_, cells)| cells.get(4)?.parse::<f64>().ok());
        let each = each
            .with_context(|| format!("{PAGE}: has no row for posecut-{}; measure it first", case.program))?;
        let size = case.size / 10;
        let bound = MARGIN * (BASE + each * size.max(1) as f64);
        let peak = found.peak as f64;
        println!(
            "{:11} {size:8} {:14} {:8.1} MB, bound {:8.1} MB",
            case.program,
            case.kind.name(),
            peak / MEBIBYTE,
            bound / MEBIBYTE
        );
        if peak > bound {
            wrong.push(case.program);
        }
    }
    if wrong.is_empty() {
        return Ok(Verdict::Holds);
    }
    eprintln!("these programs need more memory than {PAGE} allows: {}", wrong.join(", "));
    Ok(Verdict::Fails)
}

fn row(case: &Case, found: &Measured, read: u64, date: &str) -> Vec<String> {
    let options: Vec<&str> =
        case.options.iter().copied().filter(|word| !["--overwrite", "--"].contains(word)).collect();
    let peak = found.peak as f64;
    vec![
        format!("posecut-{}", case.program),
        if options.is_empty() { String::new() } else { format!("`{}`", options.join(" ")) },
        format!("{} {}", case.size, case.kind.unit()),
        format!("{:.0}", read as f64 / MEBIBYTE),
        format!("{:.0}", (peak - BASE).max(0.0) / case.size as f64),
        format!("{:.0}", peak / MEBIBYTE),
        format!("{:.1}", found.wall),
        date.to_owned(),
    ]
}

fn record(only: &[String], inputs: &Inputs) -> anyhow::Result<()> {
    let (page, date) = (root().join(PAGE), today()?);
    let mut found = known(&page)?;
    for case in CASES.iter().filter(|case| only.is_empty() || only.iter().any(|name| name == case.program)) {
        let (measured, read) = measured(case, inputs, 1)?;
        let row = row(case, &measured, read, &date);
        println!("{}", row.join(" | "));
        found.retain(|(name, _)| name != case.program);
        found.push((case.program.to_owned(), row));
    }
    write(&found, &page, &Machine::here())
}

/// Writes the table of the document, and the line in each program's README.
fn write(found: &[(String, Vec<String>)], page: &Path, machine: &Machine) -> anyhow::Result<()> {
    let cores = machine.cores;
    let head = ["program", "options", "input", "input, MB", "bytes for each", "peak, MB", "seconds", "date"];
    let mut text = format!(
        "Measured on {cores} cores, {:.0} GB, {}.\n\n{}\n|---|---|---:|---:|---:|---:|---:|---|\n",
        machine.gigabytes,
        std::env::consts::ARCH,
        markdown::row(&head)
    );
    for case in &CASES {
        for (_, cells) in found.iter().filter(|(name, _)| name == case.program) {
            text += &(markdown::row(cells) + "\n");
        }
    }
    replace(page, SECTION, &text)?;
    for (name, cells) in found {
        let readme = root().join("crates").join(name).join("README.md");
        let has_section =
            std::fs::read_to_string(&readme).is_ok_and(|text| text.contains("<!-- begin: memory -->"));
        let [_, options, input, _, _, peak, seconds, date] = cells.as_slice() else {
            bail!("{PAGE}: the row of posecut-{name} has {} columns, not {}", cells.len(), head.len());
        };
        if has_section {
            let options = if options.is_empty() { String::new() } else { format!(" with {options}") };
            let line = format!(
                "Memory and time: {peak} MB and {seconds} s for {input}{options} ({date}, {cores} cores): \
                 [docs/results/memory.md](../../docs/results/memory.md).\n"
            );
            replace(&readme, SECTION, &line)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_programs_that_are_not_measured_again_stay() {
        let page = root().join(PAGE);
        let text = std::fs::read_to_string(&page).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let copy = folder.path().join("memory.md");
        std::fs::write(&copy, &text).unwrap();
        for (_, cells) in known(&copy).unwrap() {
            assert!(text.contains(&markdown::row(&cells)), "{cells:?}");
        }
    }

    #[test]
    fn a_row_is_made_of_a_measurement() {
        let found = Measured { output: Vec::new(), wall: 1.24, cpu: 2.0, peak: 116 << 20 };
        assert_eq!(
            markdown::row(&row(&CASES[0], &found, 3 << 20, "2026-11-21")),
            "| posecut-simulate | `--rate 40` | 100000 m of driving | 3 | 1049 | 116 | 1.2 | 2026-11-21 |"
        );
    }
}

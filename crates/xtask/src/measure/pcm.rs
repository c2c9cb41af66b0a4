//! Measures posecut-pcm on drawn scenarios: time, memory, precision and recall, for docs/results/pcm.md.

use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use anyhow::{Context as _, bail};
use clap::Args;
use serde::Deserialize;
use serde_json::Value;
use xtask::sections::{replace, rows};
use xtask::workspace::{programs_folder, root};

use crate::Verdict;
use crate::machine::{Machine, today};
use crate::markdown;
use crate::process::{Ended, measure, shown};

/// Measure posecut-pcm on drawn scenarios: seconds, memory, precision and recall
///
/// Regenerates the section `bench` of docs/results/pcm.md. You can measure single sizes: the rows of other sizes stay. Needs
/// `cargo build --release -p posecut-pcm --example measure`. `make pcm-gates` regenerates the table of graphs with false closures.
#[derive(Args)]
pub(crate) struct Pcm {
    /// Measure with these numbers of candidates
    #[arg(long, num_args = 1.., default_values_t = [100, 1000, 5000, 10_000, 20_000, 100_000])]
    sizes: Vec<u64>,
    /// Write into the section `bench` of this document [default: docs/results/pcm.md]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

const SECTION: &str = "bench";
const HEAD: [&str; 16] = [
    "candidates",
    "false",
    "kind",
    "dim",
    "scheme",
    "pairs s, 1 thread",
    "2 threads",
    "skipped %",
    "clique s, 1 thread",
    "2 threads",
    "kept",
    "proved",
    "nodes",
    "MB",
    "precision",
    "recall",
];

/// A scenario to draw.
struct Scenario {
    size: u64,
    /// Share of false edges.
    outliers: &'static str,
    /// The kind of false edges.
    falsehood: &'static str,
    dimension: &'static str,
}

impl Scenario {
    fn all(size: u64) -> Vec<Self> {
        let mut all = Vec::new();
        for falsehood in ["uniform", "grouped", "near-miss"] {
            for outliers in ["0.1", "0.5", "0.9"] {
                all.push(Self { size, outliers, falsehood, dimension: "2" });
                if falsehood == "uniform" && size <= 5000 {
                    all.push(Self { size, outliers, falsehood, dimension: "3" });
                }
            }
        }
        all
    }

    fn scheme(&self) -> &'static str {
        if self.size > 20_000 { "cells" } else { "exact" }
    }

    /// The output of the example, and its peak memory in MB.
    fn measured(&self, threads: &str) -> anyhow::Result<(Value, f64)> {
        let mut command = Command::new(programs_folder().join("examples/measure"));
        command.args([
            &*self.size.to_string(),
            self.outliers,
            self.falsehood,
            self.dimension,
            self.scheme(),
            "1",
        ]);
        match measure(command.env("RAYON_NUM_THREADS", threads), Duration::MAX)? {
            Ended::Done(found) => {
                let printed = serde_json::from_slice(&found.output).with_context(|| shown(&command))?;
                Ok((printed, found.peak as f64 / f64::from(1 << 20)))
            }
            Ended::Failed(said) => bail!("{}: {said}", shown(&command)),
            Ended::OutOfTime => bail!("{}: was stopped", shown(&command)),
        }
    }

    fn row(&self) -> anyhow::Result<Vec<String>> {
        let ((one, memory), (both, _)) = (self.measured("1")?, self.measured("2")?);
        for key in ["clique", "grown", "precision", "recall", "nodes"] {
            if one[key] != both[key] {
                bail!(
                    "{} candidates: one thread finds {key} {}, two find {}",
                    self.size,
                    one[key],
                    both[key]
                );
            }
        }
        Ok(self.cells(&serde_json::from_value(one)?, &serde_json::from_value(both)?, memory))
    }

    fn cells(&self, one: &Found, both: &Found, memory: f64) -> Vec<String> {
        let exact = self.scheme() == "exact";
        let pairs =
            |found: &Found| if exact { format!("{:.3}", found.seconds_pairs) } else { "–".to_owned() };
        let proved = match exact {
            true if one.clique == one.upper_bound => "yes".to_owned(),
            true => format!("at most {}", one.upper_bound),
            false => "–".to_owned(),
        };
        let mut cells = vec![self.size.to_string()];
        cells.extend([self.outliers, self.falsehood, self.dimension, self.scheme()].map(str::to_owned));
        cells.extend([
            pairs(one),
            pairs(both),
            format!("{:.0}", 100.0 * one.skipped),
            format!("{:.4}", one.seconds_clique),
            format!("{:.4}", both.seconds_clique),
            (one.clique + one.grown).to_string(),
            proved,
            one.nodes.to_string(),
            format!("{memory:.0}"),
            format!("{:.4}", one.precision),
            format!("{:.4}", one.recall),
        ]);
        cells
    }
}

/// The output of the example.
#[derive(Deserialize)]
struct Found {
    seconds_pairs: f64,
    seconds_clique: f64,
    skipped: f64,
    clique: u64,
    grown: u64,
    upper_bound: u64,
    nodes: u64,
    precision: f64,
    recall: f64,
}

impl Pcm {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let document = self.output.unwrap_or_else(|| root().join("docs/results/pcm.md"));
        let size = |cells: &[String]| cells[0].parse::<u64>().ok();
        let mut table = rows(&document, SECTION)?;
        table.retain(|cells| size(cells).is_some_and(|size| !self.sizes.contains(&size)));
        for wanted in &self.sizes {
            for scenario in Scenario::all(*wanted) {
                table.push(scenario.row()?);
                eprintln!("{}", table.last().map(|row| markdown::row(row)).unwrap_or_default());
            }
        }
        // The sort is stable: rows of the same size keep their order.
        table.sort_by_key(|cells| size(cells));
        let machine = Machine::here();
        let intro = format!(
            "Measured {}, {} cores, {:.0} GB, {}. Made by `cargo xtask measure pcm`, a size at a time. Wall seconds with one thread \
             and with two; skipped: pairs that the pre-test settled; clique: search and proof, by cells everything; memory of the \
             whole process with the graph that it draws. Gate: 0.99 a pair.\n",
            today()?,
            machine.cores,
            machine.gigabytes,
            machine.model
        );
        let lines = [vec![intro], markdown::table(&markdown::cells(&HEAD), HEAD.len(), &table)].concat();
        replace(&document, SECTION, &lines.join("\n"))?;
        Ok(Verdict::Holds)
    }
}

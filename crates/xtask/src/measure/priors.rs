//! What GPS is worth to a session, with and without gross outliers, for crates/optimize/README.md.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail};
use clap::Args;
use rand_mt::Mt64;
use serde_json::{Value, json};
use xtask::sections::replace;
use xtask::workspace::root;

use crate::Verdict;
use crate::markdown::{cells, table};

/// Measure the error of simulated sessions with GPS, a tenth of it gross outliers
///
/// Simulates one session for each seed, reads it with posecut-ingest --gps gps, and moves a tenth of the priors by up to 200 m along
/// each axis. Prints the root mean square error of the positions, mean and largest over the seeds. Without priors the map has no frame:
/// it is aligned rigidly to the truth first. All others are compared as they are.
#[derive(Args)]
pub(crate) struct Priors {
    /// The folder of the programs
    #[arg(long, value_name = "DIRECTORY", default_value = "target/release")]
    programs: PathBuf,
    /// Number of sessions
    #[arg(long, value_name = "N", default_value_t = 5)]
    seeds: u64,
    /// Write the table into crates/optimize/README.md
    #[arg(long)]
    write: bool,
}

/// The largest displacement of an outlier along an axis, metres.
const FARTHEST: f64 = 200.0;
/// One prior in so many is an outlier.
const ONE_IN: u64 = 10;

/// A row: its name, whether the priors have outliers (`None`: no priors), and the arguments of posecut-optimize.
const ROWS: [(&str, Option<bool>, &[&str]); 6] = [
    ("no GPS, aligned to the truth", None, &[]),
    ("GPS", Some(false), &[]),
    ("GPS with 10 % outliers", Some(true), &[]),
    ("the same, `--kernel-prior huber`", Some(true), &["--kernel-prior", "huber"]),
    ("the same, `--kernel-prior cauchy`", Some(true), &["--kernel-prior", "cauchy"]),
    ("the same, `--gnc`", Some(true), &["--gnc"]),
];

impl Priors {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let folder = tempfile::tempdir()?;
        let mut errors = vec![Vec::new(); ROWS.len()];
        for seed in 1..=self.seeds {
            let variants = self.session(folder.path(), seed)?;
            for (row, &(_, outliers, arguments)) in errors.iter_mut().zip(&ROWS) {
                let variant = outliers.map_or(0, |outliers| 1 + usize::from(outliers));
                let optimized = folder.path().join("optimized.jsonl");
                let mut command = self.program("optimize");
                succeed(command.arg(&variants[variant]).args(arguments).arg("-o").arg(&optimized))?;
                let align = if outliers.is_none() { "se2" } else { "none" };
                let result = succeed(self.program("evaluate").arg(&optimized).args(["--align", align]))?;
                let result: Value = serde_json::from_slice(&result)?;
                row.push(result["rmse"].as_f64().context("posecut-evaluate wrote no rmse")?);
            }
        }
        let rows: Vec<Vec<String>> = ROWS
            .iter()
            .zip(&errors)
            .map(|((name, ..), errors)| {
                let mean = errors.iter().sum::<f64>() / errors.len() as f64;
                let largest = errors.iter().copied().fold(0.0, f64::max);
                vec![(*name).to_owned(), format!("{mean:.2}"), format!("{largest:.2}")]
            })
            .collect();
        let text = table(&cells(&["priors", "RMSE, mean, m", "largest"]), 1, &rows).join("\n") + "\n";
        print!("{text}");
        if self.write {
            replace(&root().join("crates/optimize/README.md"), "gps", &text)?;
        }
        Ok(Verdict::Holds)
    }

    fn program(&self, name: &str) -> Command {
        Command::new(self.programs.join(format!("posecut-{name}")))
    }

    /// A simulated session without priors, with them, and with outliers among them.
    fn session(&self, folder: &Path, seed: u64) -> anyhow::Result<[PathBuf; 3]> {
        let session = folder.join(format!("session-{seed}"));
        let seed_text = seed.to_string();
        succeed(self.program("simulate").args(["--seed", &seed_text, "-o"]).arg(&session))?;
        let graph = folder.join("graph.jsonl");
        let mut ingest = self.program("ingest");
        ingest.args(["--sigma-translation", "0.1", "--sigma-rotation", "0.02", "--gps", "gps", "-o"]);
        succeed(ingest.arg(&graph).arg(&session))?;
        let mut random = Mt64::new(seed);
        let mut texts = [String::new(), String::new(), String::new()];
        for line in fs::read_to_string(&graph)?.lines() {
            let mut record: Value = serde_json::from_str(line)?;
            let is_prior = record["kind"] == "prior";
            let spoiled = if is_prior && random.next_u64().is_multiple_of(ONE_IN) {
                for axis in 0..2 {
                    let unit = random.next_u64() as f64 / u64::MAX as f64;
                    let at = record["measurement"][axis].as_f64().context("a position has two numbers")?;
                    record["measurement"][axis] = json!(at + FARTHEST * (2.0 * unit - 1.0));
                }
                record.to_string()
            } else {
                line.to_owned()
            };
            let versions = [(!is_prior).then_some(line), Some(line), Some(spoiled.as_str())];
            for (text, version) in texts.iter_mut().zip(versions) {
                if let Some(version) = version {
                    text.push_str(version);
                    text.push('\n');
                }
            }
        }
        let paths = ["none", "clean", "outliers"].map(|name| folder.join(format!("{name}.jsonl")));
        for (path, text) in paths.iter().zip(texts) {
            fs::write(path, text)?;
        }
        Ok(paths)
    }
}

/// Runs a program that must succeed, and returns its standard output.
fn succeed(command: &mut Command) -> anyhow::Result<Vec<u8>> {
    let output =
        command.output().with_context(|| format!("{} cannot be started", crate::process::shown(command)))?;
    if !output.status.success() {
        bail!("{}: {}", crate::process::shown(command), String::from_utf8_lossy(&output.stderr));
    }
    Ok(output.stdout)
}

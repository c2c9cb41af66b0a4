//! Times the incremental solver with a lag beside gtsam's fixed-lag smoothers, for docs/results/incremental.md.

use std::path::PathBuf;
use std::process::Command;

use clap::Args;
use serde::Deserialize;
use xtask::sections::replace;
use xtask::workspace::root;

use super::incremental::PAGE;
use super::peers::{python, script};
use super::programs::bench_program;
use crate::Verdict;
use crate::machine::{Machine, today};
use crate::markdown;
use crate::numbers::{general, thousands};
use crate::process::must;

/// Time a session with a lag, beside gtsam's fixed-lag smoothers
///
/// A simulated session of 100,000 poses on a Manhattan grid, with landmark edges at returns to a place within the lag. gtsam's
/// IncrementalFixedLagSmoother and BatchFixedLagSmoother read the same graph and end after a number of CPU seconds. Needs gtsam; the
/// machine should be idle.
#[derive(Args)]
pub(crate) struct Lag {
    /// Measure these lags, in poses, each with the share of returns to a place that give a landmark edge
    #[arg(value_name = "LAG:SHARE", default_values = ["100:1", "1000:1", "1000:0.05", "10000:0.05"])]
    cases: Vec<String>,
    /// Number of poses
    #[arg(long, value_name = "N", default_value_t = 100_000)]
    poses: usize,
    /// CPU seconds after which a run of gtsam ends
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0)]
    limit: f64,
    /// Use this bench program [default: build it with cargo bench]
    #[arg(long, value_name = "PROGRAM")]
    bench: Option<PathBuf>,
    /// Write the table into docs/results/incremental.md
    #[arg(long)]
    write: bool,
}

const HEAD: [&str; 11] = [
    "lag",
    "solver",
    "poses done",
    "landmark edges",
    "median ms",
    "p99 ms",
    "max ms",
    "MB",
    "window m",
    "bend m",
    "all m",
];

/// The output of the bench program.
#[derive(Deserialize)]
struct Ours {
    poses: u64,
    landmark_edges: u64,
    median_ms: f64,
    p99_ms: f64,
    max_ms: f64,
    megabytes: f64,
    largest_prior: usize,
    live_m: f64,
    shape_m: f64,
    all_m: f64,
    truth_m: f64,
    batch_truth_m: f64,
    batch_converged: bool,
}

/// The output of the peer.
#[derive(Deserialize)]
struct Theirs {
    steps: u64,
    quantiles_ms: [f64; 3],
    megabytes: f64,
    live_m: Option<f64>,
    error: Option<String>,
    version: String,
}

/// The measurements with one lag: ours, and theirs by name.
struct Row {
    lag: usize,
    ours: Ours,
    theirs: Vec<(&'static str, Theirs)>,
}

impl Lag {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let python = python(&["gtsam"])?;
        let bench = self.bench.map_or_else(|| bench_program("posecut-isam", "lag"), Ok)?;
        let folder = tempfile::tempdir()?;
        let file = folder.path().join("session.g2o");
        let mut rows = Vec::new();
        for case in &self.cases {
            let (lag, share) = case.split_once(':').unwrap_or((case, "1"));
            let (lag, share): (usize, f64) = (lag.parse()?, share.parse()?);
            let mut command = Command::new(&bench);
            command.args([format!("poses={}", self.poses), format!("lag={lag}"), format!("share={share}")]);
            command.arg(format!("export={}", file.display()));
            let ours = serde_json::from_slice(&must(&mut command)?)?;
            let mut theirs = Vec::new();
            for kind in ["incremental", "batch"] {
                let mut command = Command::new(&python);
                command.arg(script("fixed-lag")).arg(&file).arg(kind);
                command.args([lag.to_string(), self.limit.to_string()]);
                theirs.push((kind, serde_json::from_slice(&must(&mut command)?)?));
            }
            rows.push(Row { lag, ours, theirs });
        }
        let text = table(&rows, &Machine::here(), &today()?);
        println!("{text}");
        if self.write {
            replace(&root().join(PAGE), "lag", &text)?;
        }
        Ok(Verdict::Holds)
    }
}

fn times(values: [f64; 3]) -> [String; 3] {
    values.map(|value| general(value, 3))
}

fn table(rows: &[Row], machine: &Machine, date: &str) -> String {
    let (mut cells, mut notes) = (Vec::new(), Vec::new());
    for Row { lag, ours, theirs } in rows {
        let mut line = vec![thousands(*lag as u64), "posecut".to_owned(), thousands(ours.poses)];
        line.push(thousands(ours.landmark_edges));
        line.extend(times([ours.median_ms, ours.p99_ms, ours.max_ms]));
        line.push(general(ours.megabytes, 3));
        line.extend(times([ours.live_m, ours.shape_m, ours.all_m]));
        cells.push(line);
        let batch = if ours.batch_converged { "" } else { " (did not converge)" };
        notes.push(format!(
            "lag {}: the largest prior joins {} poses; distance from the truth {} m, of the batch optimum{batch} {} m",
            thousands(*lag as u64),
            ours.largest_prior,
            general(ours.truth_m, 3),
            general(ours.batch_truth_m, 3)
        ));
        for (kind, theirs) in theirs {
            let done = thousands(theirs.steps);
            let mut line = vec![thousands(*lag as u64), format!("gtsam, {kind}"), done, String::new()];
            line.extend(times(theirs.quantiles_ms));
            line.push(general(theirs.megabytes, 3));
            line.push(theirs.live_m.map_or_else(String::new, |distance| general(distance, 3)));
            line.extend([String::new(), String::new()]);
            cells.push(line);
            if let Some(error) = &theirs.error {
                notes.push(format!("gtsam, {kind}, lag {} ended with \"{error}\"", thousands(*lag as u64)));
            }
        }
    }
    let version = rows.first().and_then(|row| row.theirs.first()).map_or("", |(_, theirs)| &theirs.version);
    format!(
        "{date}, {} cores ({}), {:.0} GB, gtsam {version}; one thread each.\n\n{}\n\n{}.",
        machine.cores,
        machine.model,
        machine.gigabytes,
        markdown::table(&markdown::cells(&HEAD), 2, &cells).join("\n"),
        notes.join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurements_make_rows_and_notes() {
        let ours = r#"{"poses": 100000, "landmark_edges": 3210, "median_ms": 0.00912, "p99_ms": 8.2157, "max_ms": 31.69,
            "megabytes": 24.46, "largest_prior": 251, "live_m": 0.0354, "shape_m": 0.00197, "all_m": 0.168, "truth_m": 7.674,
            "batch_truth_m": 7.677, "batch_converged": true}"#;
        let theirs = r#"{"steps": 4321, "quantiles_ms": [1.5, 20.25, 400.0], "megabytes": 100.0, "live_m": null,
            "error": "key 7", "version": "4.3.0"}"#;
        let row = Row {
            lag: 1000,
            ours: serde_json::from_str(ours).unwrap(),
            theirs: vec![("incremental", serde_json::from_str(theirs).unwrap())],
        };
        let machine = Machine { cores: 2, gigabytes: 23.6, model: "AMD EPYC".to_owned() };
        let text = table(&[row], &machine, "2026-11-25");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(
            lines[4],
            "| 1,000 | posecut | 100,000 | 3,210 | 0.00912 | 8.22 | 31.7 | 24.5 | 0.0354 | 0.00197 | 0.168 |"
        );
        assert_eq!(lines[5], "| 1,000 | gtsam, incremental | 4,321 |  | 1.5 | 20.2 | 400 | 100 |  |  |  |");
        assert!(text.ends_with(r#"gtsam, incremental, lag 1,000 ended with "key 7"."#), "{text}");
        assert!(text.contains("the largest prior joins 251 poses; distance from the truth 7.67 m"), "{text}");
    }
}

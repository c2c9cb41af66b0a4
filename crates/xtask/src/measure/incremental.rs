//! Times the incremental solver beside gtsam's ISAM2, for docs/results/incremental.md.

use std::path::PathBuf;
use std::process::Command;

use anyhow::bail;
use clap::Args;
use serde::Deserialize;
use xtask::sections::replace;
use xtask::workspace::{root, shared_data};

use super::peers::{python, script};
use super::programs::bench_program;
use crate::Verdict;
use crate::machine::{Machine, today};
use crate::markdown;
use crate::numbers::scientific;
use crate::process::must;

/// Time the incremental solver and gtsam's ISAM2
///
/// Both read a benchmark graph pose by pose, each with the edges that end at it, and compute the estimate of the newest pose after
/// every step. "same" uses gtsam's thresholds: relinearisation beyond 0.1 every 10 steps, propagation beyond 0.001, of all edges at
/// a pose beyond them. Needs gtsam and POSECUT_SHARED_DATA; the machine should be idle.
#[derive(Args)]
pub(crate) struct Incremental {
    /// Measure these graphs [default: M3500 sphere2500 city10000]
    graphs: Vec<String>,
    /// Use this bench program [default: build it with cargo bench]
    #[arg(long)]
    bench: Option<PathBuf>,
    /// Write the table into docs/results/incremental.md
    #[arg(long)]
    write: bool,
}

pub(super) const PAGE: &str = "docs/results/incremental.md";
/// Name, lowest known cost and dimension of each graph.
const GRAPHS: [(&str, f64, &str); 3] = [
    ("M3500", 137.914_878_247, "2"),
    ("sphere2500", 1_351.401_925_85, "3"),
    ("city10000", 511.987_450_599, "2"),
];
const SAME: [&str; 7] = [
    "translation=0.1",
    "rotation=0.1",
    "propagate=0.001",
    "error=0",
    "every=10",
    "iterations=1",
    "checkpoints=0",
];
const HEAD: [&str; 10] = [
    "graph",
    "solver",
    "total s",
    "median ms",
    "p95 ms",
    "p99 ms",
    "max ms",
    "gap at the end",
    "worst gap at 10 checkpoints",
    "gap after one full relinearisation",
];

/// The output of the peer.
#[derive(Deserialize)]
struct Theirs {
    total_s: f64,
    quantiles_ms: [f64; 4],
    cost: f64,
    version: String,
}

/// The output of the bench program.
#[derive(Deserialize)]
struct Ours {
    newest_s: f64,
    median_ms: f64,
    p95_ms: f64,
    p99_ms: f64,
    max_ms: f64,
    gap: f64,
    polished_gap: f64,
    worst_checkpoint_gap: Option<f64>,
}

impl Incremental {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let all = || GRAPHS.iter().map(|(name, ..)| (*name).to_owned()).collect();
        let names = if self.graphs.is_empty() { all() } else { self.graphs };
        let python = python(&["gtsam"])?;
        let data = shared_data()?.join("g2o");
        let bench = self.bench.map_or_else(|| bench_program("posecut-isam", "incremental"), Ok)?;
        let mut measured = Vec::new();
        for name in names {
            let Some((name, best, dimension)) = GRAPHS.iter().find(|(known, ..)| *known == name) else {
                bail!("the lowest cost of {name} is unknown; measure M3500, sphere2500 or city10000");
            };
            let mut isam2 = Command::new(&python);
            isam2.arg(script("isam2")).arg(data.join(format!("{name}.g2o"))).args([dimension, "10"]);
            let theirs: Theirs = serde_json::from_slice(&must(&mut isam2)?)?;
            let ours = |arguments: &[&str]| -> anyhow::Result<Ours> {
                Ok(serde_json::from_slice(&must(Command::new(&bench).arg(name).args(arguments))?)?)
            };
            measured.push((*name, *best, theirs, ours(&SAME)?, ours(&["checkpoints=10"])?));
        }
        let text = table(&measured, &Machine::here(), &today()?);
        println!("{text}");
        if self.write {
            replace(&root().join(PAGE), "table", &text)?;
        }
        Ok(Verdict::Holds)
    }
}

fn row(name: &str, solver: &str, total: f64, quantiles: [f64; 4], gaps: [Option<f64>; 3]) -> Vec<String> {
    let [median, p95, p99, largest] = quantiles;
    let mut cells = vec![name.to_owned(), solver.to_owned(), format!("{total:.2}"), format!("{median:.3}")];
    cells.extend([format!("{p95:.2}"), format!("{p99:.2}"), format!("{largest:.1}")]);
    cells.extend(gaps.map(|gap| gap.map_or_else(String::new, |gap| scientific(gap, 1))));
    cells
}

fn table(measured: &[(&str, f64, Theirs, Ours, Ours)], machine: &Machine, date: &str) -> String {
    let (mut rows, mut ratios) = (Vec::new(), Vec::new());
    for (name, best, theirs, same, default) in measured {
        let gap = theirs.cost / best - 1.0;
        rows.push(row(name, "gtsam ISAM2", theirs.total_s, theirs.quantiles_ms, [Some(gap), None, None]));
        for (label, ours, worst) in
            [("posecut, same", same, None), ("posecut, default", default, default.worst_checkpoint_gap)]
        {
            let quantiles = [ours.median_ms, ours.p95_ms, ours.p99_ms, ours.max_ms];
            rows.push(row(
                name,
                label,
                ours.newest_s,
                quantiles,
                [Some(ours.gap), worst, Some(ours.polished_gap)],
            ));
            let share = 100.0 * ours.newest_s / theirs.total_s;
            ratios.push(format!("{name}, {label}: {share:.0} % of gtsam's time"));
        }
    }
    let version = measured.first().map_or("", |(_, _, theirs, ..)| &theirs.version);
    format!(
        "{date}, {} cores ({}), {:.0} GB, gtsam {version}; one thread each.\n\n{}\n\n{}.",
        machine.cores,
        machine.model,
        machine.gigabytes,
        markdown::table(&markdown::cells(&HEAD), HEAD.len(), &rows).join("\n"),
        ratios.join("; ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The expected rows of M3500 are those of docs/results/incremental.md on 2026-11-21.
    #[test]
    fn recorded_measurements_make_the_rows_of_the_page() {
        let theirs = r#"{"total_s": 2.612, "quantiles_ms": [0.1371, 3.221, 6.913, 43.55], "cost": 137.9466, "version": "4.3.0"}"#;
        let same = r#"{"newest_s": 0.331, "median_ms": 0.0141, "p95_ms": 0.28, "p99_ms": 0.9, "max_ms": 11.7, "gap": 3.2e-4,
            "polished_gap": 8.3e-9, "worst_checkpoint_gap": null}"#;
        let default = r#"{"newest_s": 0.42, "median_ms": 0.0141, "p95_ms": 0.39, "p99_ms": 1.74, "max_ms": 11.1, "gap": 3.3e-6,
            "polished_gap": 3.3e-10, "worst_checkpoint_gap": 1.3e-5}"#;
        let measured = (
            "M3500",
            GRAPHS[0].1,
            serde_json::from_str(theirs).unwrap(),
            serde_json::from_str(same).unwrap(),
            serde_json::from_str(default).unwrap(),
        );
        let machine = Machine { cores: 2, gigabytes: 23.6, model: "AMD EPYC".to_owned() };
        let text = table(&[measured], &machine, "2026-11-21");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], "2026-11-21, 2 cores (AMD EPYC), 24 GB, gtsam 4.3.0; one thread each.");
        assert_eq!(lines[4], "| M3500 | gtsam ISAM2 | 2.61 | 0.137 | 3.22 | 6.91 | 43.5 | 2.3e-04 |  |  |");
        assert_eq!(
            lines[5],
            "| M3500 | posecut, same | 0.33 | 0.014 | 0.28 | 0.90 | 11.7 | 3.2e-04 |  | 8.3e-09 |"
        );
        assert!(lines[6].ends_with("| 11.1 | 3.3e-06 | 1.3e-05 | 3.3e-10 |"), "{}", lines[6]);
        assert!(text.ends_with(
            "M3500, posecut, same: 13 % of gtsam's time; M3500, posecut, default: 16 % of gtsam's time."
        ));
    }
}

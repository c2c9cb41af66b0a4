//! Checks on how a program behaves among others.

use super::{Bench, Check, Verdict, must};
use crate::report::Level;

pub(super) const CHECKS: &[Check] = &[
    Check {
        name: "closed-pipe",
        level: Level::Must,
        demand: "ends quietly if its output is closed",
        works_on_output: true,
        test: closed_pipe,
    },
    Check {
        name: "canonical-order",
        level: Level::Should,
        demand: "writes the header, then nodes, then edges, each by id",
        works_on_output: true,
        test: canonical_order,
    },
    Check {
        name: "help",
        level: Level::Should,
        demand: "answers --help and --version",
        works_on_output: true,
        test: help,
    },
];

fn closed_pipe(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    let run = bench.program.run_into_closed_pipe(&[], &bench.input)?;
    let quiet = !run.stderr.contains("Traceback") && !run.stderr.to_lowercase().contains("error");
    Ok(must((run.succeeded() || run.closed_pipe) && quiet, || run.said()))
}

fn canonical_order(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    let mut last = (0, 0);
    for line in bench.base.stdout.split(|&byte| byte == b'\n').filter(|line| !line.is_empty()) {
        let value: serde_json::Value = serde_json::from_slice(line)?;
        let rank = match value["kind"].as_str() {
            Some("header") => 0,
            Some("node") => 1,
            Some("odometry" | "landmark") => 2,
            _ => 3,
        };
        let place = (rank, if rank == 3 { 0 } else { value["id"].as_u64().unwrap_or(0) });
        if place < last {
            return Ok(Err(format!("{} {} comes too late", value["kind"], value["id"])));
        }
        last = place;
    }
    Ok(Ok(()))
}

fn help(bench: &Bench<'_>) -> anyhow::Result<Verdict> {
    for question in ["--help", "--version"] {
        let run = bench.program.run(&[question], b"")?;
        if !run.succeeded() || run.stdout.is_empty() {
            return Ok(Err(format!("{question}: {}", run.said())));
        }
    }
    Ok(Ok(()))
}

//! Measures maps of many simulated NCLT sessions at the full rate of their images.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use xtask::workspace::program;

use super::pinned::{Pinned, nodes, work};
use super::{Named, Results, named};
use crate::markdown;
use crate::numbers::thousands;
use crate::process::Measured;

/// Numbers of sessions; NCLT has 27.
const NUMBERS: [usize; 3] = [3, 9, 27];
/// The landmark edges of a session, on average.
const EDGES: usize = 11_000;

#[derive(Deserialize)]
#[serde(transparent)]
pub(super) struct Maps(#[serde(deserialize_with = "named")] Named<Run>);

#[derive(Deserialize, Serialize)]
struct Run {
    poses: u64,
    edges: u64,
    /// The whole process with one thread and with two.
    seconds: [f64; 2],
    optimisation: [f64; 2],
    megabytes: f64,
    iterations: u64,
    factorizations: u64,
    start: String,
    converged: bool,
    chi_square: f64,
}

/// The keyframes of a session at 5 Hz, simulated with a seed of its own.
fn session(number: usize) -> anyhow::Result<PathBuf> {
    // No date of NCLT: these are no sessions of NCLT.
    let folder = work().join(format!("2100-01-{number:02}"));
    let graph = work().join(format!("session-{number}.jsonl"));
    let seed = number.to_string();
    let words = ["--seed", &seed, "--overwrite", "-o"];
    Pinned::posecut("simulate").words(&words).path(&folder).must()?;
    Pinned::posecut("ingest").path(&folder).words(&["--keep-every", "1", "-o"]).path(&graph).must()?;
    std::fs::remove_dir_all(&folder)?;
    Ok(graph)
}

/// The map of these sessions, with correct landmark edges between near viewpoints.
fn map(sessions: &[PathBuf]) -> anyhow::Result<PathBuf> {
    let graph = work().join("sessions.jsonl");
    let construct = sessions.iter().fold(Pinned::posecut("construct"), Pinned::path);
    let edges = (EDGES * sessions.len()).to_string();
    let words = ["--split", "none", "--radius", "0.5", "--heading", "10", "--correct-edges", &edges, "-o"];
    construct.words(&words).path(&graph).must()?;
    Ok(graph)
}

pub(super) fn measure(results: &mut Results) -> anyhow::Result<()> {
    let (stats, output) = (work().join("stats.json"), work().join("out.jsonl"));
    let most = NUMBERS.iter().max().copied().unwrap_or_default();
    let sessions: Vec<PathBuf> = (1..=most).map(session).collect::<anyhow::Result<_>>()?;
    for number in NUMBERS {
        let graph = map(&sessions[..number])?;
        let run = |threads: usize| -> anyhow::Result<(Measured, Map<String, Value>)> {
            let optimize = Pinned::new(&program("optimize"), threads).words(&["-q"]).path(&graph);
            let run = optimize.words(&["-o"]).path(&output).words(&["--stats"]).path(&stats).must()?;
            Ok((run, serde_json::from_str(&std::fs::read_to_string(&stats)?)?))
        };
        let ((one, said), (two, said_with_two)) = (run(1)?, run(2)?);
        let of = |key: &str| said.get(key).cloned().unwrap_or(Value::Null);
        let run = Run {
            poses: nodes(&graph)?,
            edges: serde_json::from_value(of("edges"))?,
            seconds: [one.wall, two.wall],
            optimisation: [of("optimize_seconds"), said_with_two["optimize_seconds"].clone()]
                .map(|seconds| seconds.as_f64().unwrap_or(f64::NAN)),
            megabytes: one.peak as f64 / f64::from(1 << 20),
            iterations: serde_json::from_value(of("iterations"))?,
            factorizations: serde_json::from_value(of("factorizations"))?,
            start: serde_json::from_value(of("start"))?,
            converged: serde_json::from_value(of("converged"))?,
            chi_square: serde_json::from_value(of("chi_square"))?,
        };
        results.keep(&["sessions", &number.to_string()], run)?;
    }
    Ok(())
}

pub(super) fn table(found: &Maps) -> String {
    let head = [
        "sessions",
        "poses",
        "edges",
        "optimisation, s",
        "with two threads, s",
        "whole process, s",
        "with two threads, s",
        "peak MB",
        "steps (factorisations)",
        "start",
        "converged",
        "chi-square per freedom",
    ];
    let row = |(number, run): &(String, Run)| {
        let freedom = 3 * (run.edges + 1 - run.poses);
        vec![
            number.clone(),
            thousands(run.poses),
            thousands(run.edges),
            format!("{:.2}", run.optimisation[0]),
            format!("{:.2}", run.optimisation[1]),
            format!("{:.2}", run.seconds[0]),
            format!("{:.2}", run.seconds[1]),
            format!("{:.0}", run.megabytes),
            format!("{} ({})", run.iterations, run.factorizations),
            run.start.clone(),
            if run.converged { "yes" } else { "no" }.to_owned(),
            format!("{:.3}", run.chi_square / freedom as f64),
        ]
    };
    let rows: Vec<Vec<String>> = found.0.iter().map(row).collect();
    markdown::table(&markdown::cells(&head), head.len(), &rows).join("\n")
}

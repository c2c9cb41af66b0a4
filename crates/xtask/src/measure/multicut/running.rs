//! Solves one instance with posecut-partition and with the peer.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use anyhow::Context as _;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use xtask::workspace::program;

use super::Instance;
use crate::measure::peers::script;

/// Time limits, seconds.
#[derive(Clone, Copy)]
pub(super) struct Limits {
    pub(super) own: u64,
    pub(super) peer: u64,
}

/// The measurements of one instance. `None` for a process that failed or exceeded its limit.
#[derive(Deserialize, Serialize)]
pub(super) struct Found {
    pub(super) name: String,
    pub(super) exact: Option<Solved>,
    /// Results of the peer's solver.
    #[serde(default)]
    pub(super) peer: Peers,
}

#[derive(Default, Deserialize, Serialize)]
pub(super) struct Peers {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gaec: Option<(Option<Solved>, Option<Peer>)>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    klj: Option<(Option<Solved>, Option<Peer>)>,
}

impl Peers {
    /// The peer's solvers with the results of both programs.
    pub(super) fn all(&self) -> impl Iterator<Item = (&'static str, &(Option<Solved>, Option<Peer>))> {
        [("gaec", &self.gaec), ("klj", &self.klj)]
            .into_iter()
            .filter_map(|(name, both)| Some((name, both.as_ref()?)))
    }
}

/// A process of posecut-partition: CPU seconds, MB, and its `--stats`.
#[derive(Clone, Deserialize, Serialize)]
pub(super) struct Solved {
    pub(super) cpu: f64,
    pub(super) memory: f64,
    pub(super) nodes: u64,
    pub(super) edges: u64,
    pub(super) kernel_edges: u64,
    pub(super) objective: f64,
    pub(super) lower_bound: f64,
    pub(super) optimal: bool,
    pub(super) gap: Option<f64>,
    #[serde(flatten)]
    others: Map<String, Value>,
}

/// A process of the peer, and its output.
#[derive(Clone, Deserialize, Serialize)]
pub(super) struct Peer {
    pub(super) cpu: f64,
    memory: f64,
    pub(super) objective: f64,
    pub(super) solve_cpu_seconds: f64,
    pub(super) version: String,
}

/// Runs a process, and returns its JSON object with its CPU seconds and memory; `None` if it fails or exceeds the
/// limit.
fn measured(
    command: &mut Command,
    limit: u64,
    object: impl FnOnce(Vec<u8>) -> anyhow::Result<Vec<u8>>,
) -> anyhow::Result<Option<Value>> {
    let Some(run) = crate::process::measure(command, Duration::from_secs(limit))?.done() else {
        return Ok(None);
    };
    let mut found = Map::new();
    found.insert("cpu".to_owned(), run.cpu.into());
    found.insert("memory".to_owned(), (run.peak as f64 / f64::from(1 << 20)).into());
    let printed: Map<String, Value> = serde_json::from_slice(&object(run.output)?)?;
    found.extend(printed);
    Ok(Some(found.into()))
}

fn solve(path: &Path, solver: &str, limit: u64, folder: &Path) -> anyhow::Result<Option<Solved>> {
    let (stats, labels) = (folder.join("stats.json"), folder.join("labels"));
    let mut command = Command::new(program("partition"));
    command.arg("solve").arg(path).args(["--solver", solver, "--time-limit", &limit.to_string()]);
    command.args(["--threads", "1", "-q", "--stats"]).arg(&stats).arg("-o").arg(&labels);
    let found = measured(&mut command, 4 * limit + 60, |_| Ok(std::fs::read(&stats)?))?;
    found
        .map(serde_json::from_value)
        .transpose()
        .context("the output of posecut-partition --stats lacks fields of the tables")
}

fn solve_by_peer(python: &Path, path: &Path, solver: &str, limit: u64) -> anyhow::Result<Option<Peer>> {
    let mut command = Command::new(python);
    command.arg(script("bioimage")).arg(solver).arg(path);
    let found = measured(&mut command, limit, Ok)?;
    found
        .map(serde_json::from_value)
        .transpose()
        .context("the output of scripts/peer-bioimage.py lacks fields of the tables")
}

/// What to measure of an instance.
#[derive(Clone, Copy)]
pub(super) struct Wanted<'a> {
    pub(super) exact: bool,
    /// The Python of the peer.
    pub(super) peer: Option<&'a Path>,
    pub(super) limits: Limits,
}

/// Measures an instance.
pub(super) fn measure(instance: &Instance, wanted: Wanted, folder: &Path) -> anyhow::Result<Found> {
    let (path, limits) = (&instance.path, wanted.limits);
    let exact = if wanted.exact { solve(path, "exact", limits.own, folder)? } else { None };
    let both = |solver: &str| {
        let beside = |python| {
            let theirs = solve_by_peer(python, path, solver, limits.peer)?;
            anyhow::Ok((solve(path, solver, limits.own, folder)?, theirs))
        };
        wanted.peer.map(beside).transpose()
    };
    Ok(Found { name: instance.name.clone(), exact, peer: Peers { gaec: both("gaec")?, klj: both("klj")? } })
}

//! Collects the results of many runs in one file.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use anyhow::{Context as _, bail};
use serde::Serialize;
use serde_json::{Map, Value};

use crate::journal::Journals;
use crate::{Plan, Task, times};

/// The fields of a result that are kept: those that tables and maps need, without history and per-session detail.
const KEPT: &[&str] = &[
    "format",
    "version",
    "labels",
    "rmse",
    "components",
    "poses",
    "poses_unmatched",
    "ground_truth",
    "edges",
    "calibration",
    "doubts",
];

/// The collected results.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Collected {
    /// One JSON object a line, in the plan's order: the same bytes for the same results.
    pub results: Vec<u8>,
    /// The CPU seconds of the runs' methods, one JSON object a line. They differ from run to run.
    pub times: Vec<u8>,
    /// The number of results found.
    pub found: usize,
    /// Failed runs.
    pub failed: usize,
    /// The number of results that are missing although no run failed.
    pub missing: usize,
}

/// A failed run as a result.
#[derive(Serialize)]
struct FailedResult<'a> {
    format: &'static str,
    version: u64,
    labels: &'a BTreeMap<String, Value>,
    failed: &'a str,
}

/// The CPU seconds of a method on one graph.
#[derive(Serialize)]
struct RunTime<'a> {
    labels: &'a BTreeMap<String, Value>,
    cpu_seconds: f64,
}

/// Collects the existing results of a plan, in the plan's order, and its failed runs.
pub fn collect(plan: &Plan) -> anyhow::Result<Collected> {
    let dependencies = plan.dependencies()?;
    let mut journals = Journals::default();
    // For each task, why it has no output: its own failure, or that of the first task that it reads from.
    let mut failures: Vec<Option<String>> = Vec::with_capacity(plan.tasks.len());
    let places: HashMap<&str, usize> =
        plan.tasks.iter().enumerate().map(|(place, task)| (task.id.as_str(), place)).collect();
    let mut seconds: HashMap<&str, BTreeMap<String, (String, f64)>> = HashMap::new();
    let mut collected = Collected::default();
    for (place, task) in plan.tasks.iter().enumerate() {
        journals.load(&task.group)?;
        let own = journals.get(&task.group, &task.id).filter(|entry| entry.digest == task.digest);
        let own = own.and_then(|entry| entry.failed.clone());
        failures.push(own.or_else(|| dependencies[place].iter().find_map(|&other| failures[other].clone())));
        if !task.is_result() {
            continue;
        }
        match (&failures[place], result(task)?) {
            (Some(failed), _) => {
                let record =
                    FailedResult { format: "posecut-result", version: 1, labels: &task.labels, failed };
                line(&mut collected.results, &record)?;
                collected.failed += 1;
            }
            (None, Some(kept)) => {
                line(&mut collected.results, &kept)?;
                collected.found += 1;
            }
            (None, None) => {
                collected.missing += 1;
                continue;
            }
        }
        let mut total = Some(0.0);
        for id in &task.chain {
            let Some(step) = places.get(id.as_str()).map(|&place| &plan.tasks[place]) else { continue };
            if !seconds.contains_key(step.group.as_str()) {
                seconds.insert(&step.group, times::read(&step.group)?);
            }
            let known = seconds[step.group.as_str()].get(id).filter(|(digest, _)| *digest == step.digest);
            let reached = failures[places[id.as_str()]].is_none() || known.is_some();
            // Steps after a failed one did not run and have no time.
            if reached {
                total = total.zip(known).map(|(total, (_, seconds))| total + seconds);
            }
        }
        if let Some(cpu_seconds) = total {
            line(&mut collected.times, &RunTime { labels: &task.labels, cpu_seconds })?;
        }
    }
    Ok(collected)
}

fn line(bytes: &mut Vec<u8>, record: &impl Serialize) -> anyhow::Result<()> {
    serde_json::to_writer(&mut *bytes, record)?;
    bytes.push(b'\n');
    Ok(())
}

/// The kept fields of a result; `None` if the result does not exist.
fn result(task: &Task) -> anyhow::Result<Option<Map<String, Value>>> {
    let path = &task.id;
    let bytes = match std::fs::read(Path::new(path)) {
        Ok(bytes) => bytes,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error).with_context(|| format!("{path}: cannot be read")),
    };
    let all: Map<String, Value> = serde_json::from_slice(&bytes)
        .with_context(|| format!("{path}: is not a result; run the experiment again"))?;
    if all.get("format").and_then(Value::as_str) != Some("posecut-result") {
        bail!("{path}: is not a result of posecut-evaluate; run the experiment again");
    }
    Ok(Some(all.into_iter().filter(|(name, _)| KEPT.contains(&name.as_str())).collect()))
}

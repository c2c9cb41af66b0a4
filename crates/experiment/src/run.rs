//! Running a plan on this machine.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::process::Command;
use std::sync::{Condvar, Mutex, PoisonError};
use std::time::Instant;

use anyhow::{Context as _, bail};
use posecut_stage::{ProgressBar, warn};
use serde::Serialize;

use crate::digest::digest_path;
use crate::journal::{Entry, Journals};
use crate::lock::Lock;
use crate::make_rules::shell;
use crate::schedule::{Schedule, select};
use crate::{Plan, Task};

/// How often a task is tried before it counts as failed.
const ATTEMPTS: usize = 2;

/// Which part of a plan to run, and how.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunOptions {
    /// Tasks at once; 0 takes all processors.
    pub threads: usize,
    /// Only what several groups read: simulated sessions and session graphs.
    pub shared: bool,
    /// Only share K of N of the other groups, K from 1.
    pub shard: Option<(usize, usize)>,
}

/// What a run did.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// Tasks run.
    pub run: usize,
    /// Tasks that were finished before or that nobody needs.
    pub finished_before: usize,
    /// Tasks that failed twice, with what they said.
    pub failed: Vec<String>,
    /// Tasks that read what a failed one should have written.
    pub not_run: usize,
    /// Tasks and their wall time by stage.
    pub stages: BTreeMap<String, StageTime>,
}

/// Where the time went.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct StageTime {
    /// Calls.
    pub tasks: usize,
    /// Their wall time, seconds.
    pub seconds: f64,
}

struct Shared {
    schedule: Schedule,
    journals: Journals,
    summary: Summary,
    running: usize,
    /// An error of the runner itself, which ends the run.
    broken: Option<anyhow::Error>,
}

/// Runs what has not been run: each task once what it reads is there, temporary files removed once nobody reads
/// them. A task that fails is tried once more; what depends on it is left out, and everything else still runs.
pub fn run(plan: &Plan, options: &RunOptions, progress: &ProgressBar) -> anyhow::Result<Summary> {
    let selected = select(plan, &plan.dependencies()?, options);
    let Some(first) = selected.iter().position(|selected| *selected) else { return Ok(Summary::default()) };
    let lock = Lock::take(&plan.tasks[first].group)?;
    let mut journals = Journals::default();
    let schedule = Schedule::new(plan, &mut journals, options)?;
    let threads = match options.threads {
        0 => std::thread::available_parallelism().map_or(1, std::num::NonZero::get),
        threads => threads,
    };
    progress.set_length(schedule.needed as u64);
    let needed = schedule.needed;
    let summary = Summary { finished_before: schedule.finished, ..Summary::default() };
    let shared = Mutex::new(Shared { schedule, journals, summary, running: 0, broken: None });
    let changed = Condvar::new();
    std::thread::scope(|scope| {
        for _ in 0..threads.min(needed) {
            scope.spawn(|| work(plan, &lock, threads, &shared, &changed, progress));
        }
    });
    let mut shared = shared.into_inner().unwrap_or_else(PoisonError::into_inner);
    let groups: HashSet<&str> = plan.tasks.iter().map(|task| task.group.as_str()).collect();
    for group in groups {
        shared.journals.sort(group)?;
    }
    if let Some(error) = shared.broken {
        return Err(error);
    }
    // What a killed run left, and what a stage that outlived it wrote.
    for &place in shared.schedule.temporary.iter().filter(|&&place| shared.schedule.wanted[place] == 0) {
        plan.tasks[place].outputs.iter().try_for_each(|output| remove(output))?;
    }
    shared.summary.not_run = needed - shared.summary.run - shared.summary.failed.len();
    Ok(shared.summary)
}

fn work(
    plan: &Plan,
    lock: &Lock,
    threads: usize,
    shared: &Mutex<Shared>,
    changed: &Condvar,
    progress: &ProgressBar,
) {
    let mut state = shared.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        let Some(place) = (state.broken.is_none()).then(|| state.schedule.ready.pop_first()).flatten() else {
            if state.running == 0 || state.broken.is_some() {
                changed.notify_all();
                return;
            }
            state = changed.wait(state).unwrap_or_else(PoisonError::into_inner);
            continue;
        };
        state.running += 1;
        drop(state);
        let task = &plan.tasks[place];
        let started = Instant::now();
        let mut outcome = attempt(task, lock, threads);
        for _ in 1..ATTEMPTS {
            if let Err(error) = &outcome {
                warn!("{}: failed, and is tried again: {error:#}", task.id);
                outcome = attempt(task, lock, threads);
            }
        }
        state = shared.lock().unwrap_or_else(PoisonError::into_inner);
        state.running -= 1;
        let time = state.summary.stages.entry(task.stage.clone()).or_default();
        time.tasks += 1;
        time.seconds += started.elapsed().as_secs_f64();
        match outcome {
            Ok(outputs) => {
                if let Err(error) = finish(plan, place, outputs, &mut state) {
                    state.broken = Some(error);
                }
            }
            Err(error) => state.summary.failed.push(format!("{}: {error:#}", task.id)),
        }
        progress.inc(1);
        changed.notify_all();
    }
}

/// Notes a finished task, frees those that waited for it, and removes what nobody needs any more.
fn finish(
    plan: &Plan,
    place: usize,
    outputs: BTreeMap<String, String>,
    state: &mut Shared,
) -> anyhow::Result<()> {
    let task = &plan.tasks[place];
    if let Some(before) = state.journals.get(&task.group, &task.id)
        && before.digest == task.digest
        && before.outputs != outputs
    {
        warn!(
            "{}: the same program, arguments and input gave other bytes than before; its stage is not deterministic",
            task.id
        );
    }
    state.journals.add(&task.group, Entry { id: task.id.clone(), digest: task.digest.clone(), outputs })?;
    state.summary.run += 1;
    for reader in state.schedule.readers[place].clone() {
        state.schedule.waiting[reader] -= 1;
        if state.schedule.waiting[reader] == 0 {
            state.schedule.ready.insert(reader);
        }
    }
    for other in state.schedule.dependencies[place].clone() {
        state.schedule.wanted[other] -= 1;
        if state.schedule.wanted[other] == 0 && plan.tasks[other].temporary {
            for output in &plan.tasks[other].outputs {
                remove(output)?;
            }
        }
    }
    Ok(())
}

fn remove(output: &str) -> anyhow::Result<()> {
    match std::fs::remove_file(output) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("{output}: cannot be removed"))
        }
        _ => Ok(()),
    }
}

/// Runs a task; returns the digests of its outputs.
fn attempt(task: &Task, lock: &Lock, threads: usize) -> anyhow::Result<BTreeMap<String, String>> {
    for output in task.outputs.iter().chain(&task.statistics) {
        if let Some(folder) = Path::new(output).parent() {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("{}: cannot be made", folder.display()))?;
        }
    }
    let mut command = Command::new(&task.argv[0]);
    command.args(&task.argv[1..]).stdin(lock.stdin()?);
    if threads > 1 && std::env::var_os("RAYON_NUM_THREADS").is_none() {
        // Tasks fill the processors already; their results do not depend on the number of threads.
        command.env("RAYON_NUM_THREADS", "1");
    }
    let called = || task.argv.iter().map(|word| shell(word)).collect::<Vec<_>>().join(" ");
    let output = command.output().with_context(|| format!("cannot be started: {}", called()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let said: Vec<&str> = said.lines().rev().take(3).collect();
        let said: Vec<&str> = said.into_iter().rev().collect();
        bail!("{} of `{}`: {}", output.status, called(), said.join(" / "));
    }
    task.outputs
        .iter()
        .map(|output| {
            let digest = digest_path(Path::new(output))
                .with_context(|| format!("`{}` ended well and wrote no {output}", called()))?;
            Ok((output.clone(), digest))
        })
        .collect()
}

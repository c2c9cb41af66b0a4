//! Running a plan on this machine.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::sync::{Condvar, Mutex, PoisonError};
use std::thread::Builder;
use std::time::Instant;

use anyhow::Context as _;
use posecut_stage::{ProgressBar, info, warn};
use serde::Serialize;

use crate::call::{Outcome, call};
use crate::journal::{Entry, Journals};
use crate::lock::Lock;
use crate::schedule::{Schedule, select};
use crate::{Plan, times};

/// The number of attempts before a task counts as failed.
const ATTEMPTS: usize = 2;

/// The part of a plan to run, and how to run it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunOptions {
    /// The number of tasks to run at once; 0 uses all processors.
    pub threads: usize,
    /// Run only tasks whose outputs several groups read: simulated sessions and session graphs.
    pub shared: bool,
    /// Run only share K of N of the other groups, K from 1.
    pub shard: Option<(usize, usize)>,
    /// Run failed runs again.
    pub retry: bool,
}

/// What a run did.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// Tasks run.
    pub run: usize,
    /// Tasks that were finished before or that no remaining task needs.
    pub finished_before: usize,
    /// Failed runs: tasks with a limit that reached it or ended with an error. They count as results.
    pub failed_runs: usize,
    /// Tasks that were not run because a failed run did not write their input.
    pub without_input: usize,
    /// Tasks that failed twice, with their error messages.
    pub failed: Vec<String>,
    /// Tasks that were not run because a failed task did not write their input.
    pub not_run: usize,
    /// Tasks and their wall time by stage.
    pub stages: BTreeMap<String, StageTime>,
}

/// The time that one stage took.
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
    /// The ids of the tasks of methods: their CPU seconds are recorded.
    timed: HashSet<String>,
}

/// Runs all unfinished tasks. A task starts when its inputs are there, and temporary files are removed after their last
/// reader. A task that fails is tried once more; if it fails again, the tasks that depend on it are left out, and all others
/// still run. A task with a limit that fails is a failed run and is recorded like a finished task.
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
    let timed = plan.tasks.iter().flat_map(|task| task.chain.iter().cloned()).collect();
    let shared = Mutex::new(Shared { schedule, journals, summary, running: 0, broken: None, timed });
    let changed = Condvar::new();
    let work = || work(plan, &lock, threads, &shared, &changed, progress);
    std::thread::scope(|scope| {
        // This thread works too, so the run goes on even if no other thread can be started.
        for _ in 1..threads.min(needed) {
            if Builder::new().spawn_scoped(scope, work).is_err() {
                break;
            }
        }
        work();
    });
    let mut shared = shared.into_inner().unwrap_or_else(PoisonError::into_inner);
    let groups: HashSet<&str> = plan.tasks.iter().map(|task| task.group.as_str()).collect();
    let sorted: Vec<anyhow::Result<()>> = groups
        .into_iter()
        .map(|group| shared.journals.sort(group).and_then(|()| times::sort(group)))
        .collect();
    if let Some(error) = shared.broken {
        return Err(error);
    }
    sorted.into_iter().collect::<anyhow::Result<()>>()?;
    // Remove temporary files of a killed run, and of stages that outlived it.
    for &place in shared.schedule.temporary.iter().filter(|&&place| shared.schedule.wanted[place] == 0) {
        plan.tasks[place].outputs.iter().try_for_each(|output| remove(output))?;
    }
    let summary = &mut shared.summary;
    summary.not_run =
        needed - summary.run - summary.failed.len() - summary.failed_runs - summary.without_input;
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
        let mut outcome = call(task, lock, threads);
        for _ in 1..ATTEMPTS {
            match &outcome {
                Err(error) => warn!("{}: failed, trying again: {error:#}", task.id),
                Ok(Outcome::FailedRun { by_limit: false, .. }) => {}
                Ok(_) => break,
            }
            outcome = call(task, lock, threads);
        }
        state = shared.lock().unwrap_or_else(PoisonError::into_inner);
        state.running -= 1;
        let time = state.summary.stages.entry(task.stage.clone()).or_default();
        time.tasks += 1;
        time.seconds += started.elapsed().as_secs_f64();
        match outcome {
            Ok(outcome) => {
                if let Err(error) = note(plan, place, outcome, &mut state, progress) {
                    state.broken = Some(error);
                }
            }
            Err(error) => state.summary.failed.push(format!("{}: {error:#}", task.id)),
        }
        progress.inc(1);
        changed.notify_all();
    }
}

/// Records how a task ended.
fn note(
    plan: &Plan,
    place: usize,
    outcome: Outcome,
    state: &mut Shared,
    progress: &ProgressBar,
) -> anyhow::Result<()> {
    let task = &plan.tasks[place];
    let seconds = match &outcome {
        Outcome::Done { cpu_seconds, .. } | Outcome::FailedRun { cpu_seconds, .. } => *cpu_seconds,
    };
    if state.timed.contains(&task.id) {
        times::add(&task.group, &task.id, &task.digest, seconds)?;
    }
    match outcome {
        Outcome::Done { outputs, .. } => finish(plan, place, outputs, state),
        Outcome::FailedRun { said, .. } => fail(plan, place, said, state, progress),
    }
}

/// Records a finished task, makes the tasks that waited for it ready, and removes files that no task needs any more.
fn finish(
    plan: &Plan,
    place: usize,
    outputs: BTreeMap<String, String>,
    state: &mut Shared,
) -> anyhow::Result<()> {
    let task = &plan.tasks[place];
    if let Some(before) = state.journals.get(&task.group, &task.id)
        && before.digest == task.digest
        && before.failed.is_none()
        && before.outputs != outputs
    {
        warn!(
            "{}: the same program, arguments and input gave different bytes than before; its stage is not deterministic",
            task.id
        );
    }
    let entry = Entry { id: task.id.clone(), digest: task.digest.clone(), outputs, failed: None };
    state.journals.add(&task.group, entry)?;
    state.summary.run += 1;
    for reader in state.schedule.readers[place].clone() {
        state.schedule.waiting[reader] -= 1;
        if state.schedule.waiting[reader] == 0 && !state.schedule.doomed[reader] {
            state.schedule.ready.insert(reader);
        }
    }
    release(plan, place, state)
}

/// Records a failed run. Tasks that depend on it are not run, and outputs of all these from earlier runs are removed.
fn fail(
    plan: &Plan,
    place: usize,
    said: String,
    state: &mut Shared,
    progress: &ProgressBar,
) -> anyhow::Result<()> {
    let task = &plan.tasks[place];
    info!("{}: recorded as a failed run: {said}", task.id);
    let (id, digest) = (task.id.clone(), task.digest.clone());
    let entry = Entry { id, digest, outputs: BTreeMap::new(), failed: Some(said) };
    state.journals.add(&task.group, entry)?;
    state.summary.failed_runs += 1;
    let mut open = vec![place];
    while let Some(place) = open.pop() {
        state.schedule.doomed[place] = true;
        plan.tasks[place].outputs.iter().try_for_each(|output| remove(output))?;
        release(plan, place, state)?;
        for &reader in &state.schedule.readers[place] {
            if !state.schedule.doomed[reader] {
                state.schedule.doomed[reader] = true;
                state.summary.without_input += 1;
                progress.inc(1);
                open.push(reader);
            }
        }
    }
    Ok(())
}

/// Removes temporary files whose last reader was this task.
fn release(plan: &Plan, place: usize, state: &mut Shared) -> anyhow::Result<()> {
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
    match std::fs::remove_file(Path::new(output)) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            Err(error).with_context(|| format!("{output}: cannot be removed"))
        }
        _ => Ok(()),
    }
}

//! The tasks of a plan that still have to run, and their order.

use std::collections::{BTreeSet, HashSet};
use std::path::Path;

use anyhow::bail;

use crate::digest::digest_path;
use crate::journal::Journals;
use crate::{Plan, RunOptions, Task};

/// The state of a task before a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Finished, and its outputs are unchanged.
    Fresh,
    /// Not finished, or to be run again for a task that reads it.
    Open,
    /// A failed run. It stays failed until its digest changes.
    Failed,
}

/// The tasks to run.
pub(crate) struct Schedule {
    /// For each task, the tasks of this run that read from it.
    pub(crate) readers: Vec<Vec<usize>>,
    /// For each task, how many of the tasks that it reads from have not run yet.
    pub(crate) waiting: Vec<usize>,
    /// For each task, how many of its readers have not run yet.
    pub(crate) wanted: Vec<usize>,
    /// The tasks that can run now, in the order of the plan.
    pub(crate) ready: BTreeSet<usize>,
    /// The number of tasks to run.
    pub(crate) needed: usize,
    /// The number of tasks that need not run.
    pub(crate) finished: usize,
    /// For each task, the earlier tasks that it reads from.
    pub(crate) dependencies: Vec<Vec<usize>>,
    /// For each task, whether it is a failed run or reads from one.
    pub(crate) doomed: Vec<bool>,
    /// Temporary tasks of this call.
    pub(crate) temporary: Vec<usize>,
}

impl Schedule {
    pub(crate) fn new(plan: &Plan, journals: &mut Journals, options: &RunOptions) -> anyhow::Result<Self> {
        let dependencies = plan.dependencies()?;
        let selected = select(plan, &dependencies, options);
        let mut read = vec![false; plan.tasks.len()];
        for place in (0..plan.tasks.len()).filter(|&place| selected[place]) {
            for &other in &dependencies[place] {
                read[other] = true;
            }
        }
        let mut states = vec![State::Open; plan.tasks.len()];
        for (place, task) in plan.tasks.iter().enumerate() {
            if selected[place] || read[place] {
                journals.load(&task.group)?;
                states[place] = state(task, journals);
            }
        }
        if options.retry {
            states.iter_mut().filter(|state| **state == State::Failed).for_each(|state| *state = State::Open);
        }
        let mut doomed = vec![false; plan.tasks.len()];
        for place in 0..plan.tasks.len() {
            doomed[place] =
                states[place] == State::Failed || dependencies[place].iter().any(|&other| doomed[other]);
        }
        let mut needed: Vec<bool> = (0..plan.tasks.len())
            .map(|place| {
                !doomed[place]
                    && selected[place]
                    && !plan.tasks[place].temporary
                    && states[place] == State::Open
            })
            .collect();
        for place in (0..plan.tasks.len()).rev().filter(|&place| needed[place]).collect::<Vec<_>>() {
            mark(place, &dependencies, &states, &mut needed);
        }
        if let Some(place) = (0..plan.tasks.len()).find(|&place| needed[place] && !selected[place]) {
            bail!(
                "{}: does not exist yet, but this part of the plan reads it; run the plan with --shared first",
                plan.tasks[place].id
            );
        }
        let mut readers = vec![Vec::new(); plan.tasks.len()];
        let mut waiting = vec![0; plan.tasks.len()];
        for place in (0..plan.tasks.len()).filter(|&place| needed[place]) {
            for &other in &dependencies[place] {
                readers[other].push(place);
                waiting[place] += usize::from(needed[other]);
            }
        }
        Ok(Self {
            wanted: readers.iter().map(Vec::len).collect(),
            ready: (0..plan.tasks.len()).filter(|&place| needed[place] && waiting[place] == 0).collect(),
            finished: (0..plan.tasks.len()).filter(|&place| selected[place] && !needed[place]).count(),
            temporary: (0..plan.tasks.len())
                .filter(|&place| selected[place] && plan.tasks[place].temporary)
                .collect(),
            needed: needed.iter().filter(|needed| **needed).count(),
            readers,
            waiting,
            dependencies,
            doomed,
        })
    }
}

fn mark(place: usize, dependencies: &[Vec<usize>], states: &[State], needed: &mut [bool]) {
    for &other in &dependencies[place] {
        if states[other] == State::Open && !needed[other] {
            needed[other] = true;
            mark(other, dependencies, states, needed);
        }
    }
}

/// Selects the tasks of this call: all tasks, the tasks that several groups share, or one share of the others.
pub(crate) fn select(plan: &Plan, dependencies: &[Vec<usize>], options: &RunOptions) -> Vec<bool> {
    let mut shared: HashSet<&str> = HashSet::new();
    for (place, task) in plan.tasks.iter().enumerate() {
        for &other in &dependencies[place] {
            if plan.tasks[other].group != task.group {
                shared.insert(&plan.tasks[other].group);
            }
        }
    }
    let mut groups: Vec<&str> = Vec::new();
    let mut seen: HashSet<&str> = HashSet::new();
    for task in &plan.tasks {
        if !shared.contains(task.group.as_str()) && seen.insert(&task.group) {
            groups.push(&task.group);
        }
    }
    let own: HashSet<&str> = match options.shard {
        None => groups.into_iter().collect(),
        Some((shard, of)) => groups
            .into_iter()
            .enumerate()
            .filter(|(place, _)| place % of == shard - 1)
            .map(|(_, group)| group)
            .collect(),
    };
    plan.tasks
        .iter()
        .map(|task| {
            let group = task.group.as_str();
            if options.shared {
                shared.contains(group)
            } else {
                own.contains(group) || (options.shard.is_none() && shared.contains(group))
            }
        })
        .collect()
}

fn state(task: &Task, journals: &Journals) -> State {
    let entry = journals.get(&task.group, &task.id);
    if entry.is_some_and(|entry| entry.digest == task.digest && entry.failed.is_some()) {
        return State::Failed;
    }
    let fresh = entry.is_some_and(|entry| {
        entry.digest == task.digest
            && task.outputs.iter().all(|output| {
                entry
                    .outputs
                    .get(output)
                    .is_some_and(|stated| digest_path(Path::new(output)).is_ok_and(|found| found == *stated))
            })
    });
    if fresh { State::Fresh } else { State::Open }
}

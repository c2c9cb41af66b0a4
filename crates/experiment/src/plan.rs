//! A plan: tasks in an order in which they can run.

use std::collections::{BTreeMap, HashMap};
use std::io::{BufReader, Write};
use std::path::Path;

use anyhow::{Context as _, bail};
use posecut_stage::{bounded_lines, digest};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::digest::Digests;
use crate::programs::locate;
use crate::{Source, held};

/// One call of a stage program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Task {
    /// The id, unique in the plan: the first output.
    pub id: String,
    /// The step that the task runs.
    pub stage: String,
    /// The group of the task. A group may run on a machine of its own once the groups that it reads from are done.
    pub group: String,
    /// The command line, without a shell.
    pub argv: Vec<String>,
    /// Files and folders that the task reads.
    pub inputs: Vec<String>,
    /// Files and folders that the task writes.
    pub outputs: Vec<String>,
    /// Further files that the task writes. They contain wall times and are not results.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub statistics: Vec<String>,
    /// Files other than the program that decide what the task does, such as a script.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<String>,
    /// Whether the outputs are removed after their last reader.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub temporary: bool,
    /// The limit on CPU seconds. A task with a limit that fails is a failed run, which counts as a result.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cpu_limit: Option<u64>,
    /// The labels of a result.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub labels: BTreeMap<String, Value>,
    /// For a result, the ids of the tasks of its method. The sum of their CPU seconds is the time of the method.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub chain: Vec<String>,
    /// A digest over the arguments, the content of the program and the digests of the inputs. Equal digests mean equal outputs.
    pub digest: String,
}

/// A list of tasks. Every input of a task is written by an earlier task or exists before the run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Plan {
    /// The tasks, in an order in which they can run one after the other.
    pub tasks: Vec<Task>,
}

impl Plan {
    /// Reads a task list, and refuses one that writes outside the folders of results and simulated sessions, or whose programs or
    /// sessions have changed since.
    pub fn read(path: &Path, source: &Source) -> anyhow::Result<Self> {
        let place = path.display();
        let file = std::fs::File::open(path).with_context(|| format!("{place}: cannot be opened"))?;
        let mut plan = Self::default();
        for (number, line) in bounded_lines(BufReader::new(file)).enumerate() {
            let line = line.with_context(|| format!("{place}: cannot be read"))?;
            let task = serde_json::from_str(&line).with_context(|| {
                format!("{place}, line {}: is not a task; write the list with `plan`", number + 1)
            })?;
            plan.tasks.push(task);
        }
        held::check(&plan, source).with_context(|| place.to_string())?;
        let stated: Vec<String> = plan.tasks.iter().map(|task| task.digest.clone()).collect();
        plan.seal()?;
        for (task, stated) in plan.tasks.iter().zip(stated) {
            if task.digest != stated {
                bail!(
                    "{place}: the program or the input of {} has changed since the plan was written; run `plan` again",
                    task.id
                );
            }
        }
        Ok(plan)
    }

    /// Writes the plan, one task a line.
    pub fn write(&self, mut writer: impl Write) -> anyhow::Result<()> {
        for task in &self.tasks {
            serde_json::to_writer(&mut writer, task)?;
            writer.write_all(b"\n")?;
        }
        Ok(())
    }

    /// For each task, the indices of the tasks that it reads from.
    pub fn dependencies(&self) -> anyhow::Result<Vec<Vec<usize>>> {
        let mut writers: HashMap<&str, usize> = HashMap::new();
        let mut dependencies = Vec::with_capacity(self.tasks.len());
        for (place, task) in self.tasks.iter().enumerate() {
            let mut own: Vec<usize> =
                task.inputs.iter().filter_map(|input| writers.get(input.as_str()).copied()).collect();
            own.sort_unstable();
            own.dedup();
            dependencies.push(own);
            for output in &task.outputs {
                if let Some(other) = writers.insert(output, place) {
                    bail!("{output}: is written by two tasks, {} and {}", self.tasks[other].id, task.id);
                }
            }
        }
        Ok(dependencies)
    }

    /// Fills in the digests, from the first task to the last. Reads each program, and each input that no task writes, once.
    pub(crate) fn seal(&mut self) -> anyhow::Result<()> {
        let mut digests = Digests::default();
        let mut written: HashMap<String, String> = HashMap::new();
        for task in &mut self.tasks {
            let program = task.argv.first().with_context(|| format!("{}: has no program", task.id))?;
            let mut text = format!("posecut-task 1\n{}\n", digests.of(&locate(program)?)?);
            for file in &task.files {
                text.push_str(&format!("{}\n", digests.of(Path::new(file))?));
            }
            for argument in &task.argv[1..] {
                text.push_str(&format!("{}\n", serde_json::to_string(argument)?));
            }
            if let Some(limit) = task.cpu_limit {
                text.push_str(&format!("limit {limit}\n"));
            }
            for input in &task.inputs {
                let known = match written.get(input) {
                    Some(known) => known.clone(),
                    None => digests.of(Path::new(input))?,
                };
                text.push_str(&format!("{known}\n"));
            }
            task.digest = digest(text.as_bytes());
            for output in &task.outputs {
                written.insert(output.clone(), digest(format!("{} {output}", task.digest).as_bytes()));
            }
        }
        Ok(())
    }

    /// The files of evaluations, in the order of the plan.
    pub fn results(&self) -> impl Iterator<Item = &str> {
        self.tasks.iter().filter(|task| task.is_result()).map(|task| task.id.as_str())
    }
}

impl Task {
    /// Whether the task writes a result.
    pub(crate) fn is_result(&self) -> bool {
        self.outputs.first().is_some_and(|output| output.ends_with(".result.json"))
    }
}

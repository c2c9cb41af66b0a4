//! One task of the plan.

use anyhow::{Context as _, bail};
use serde_json::Value;

use super::{Planner, Run};
use crate::Task;
use crate::parameters::replace;
use crate::programs::locate;

/// The parts of a task other than its step.
#[derive(Default)]
pub(super) struct Parts<'a> {
    pub(super) group: &'a str,
    /// The value of `{input}`; several words if a stage reads several files.
    pub(super) inputs: &'a [String],
    pub(super) output: String,
    /// Further inputs that `{input}` does not name.
    pub(super) more_inputs: Vec<String>,
    /// Options that follow the declared ones.
    pub(super) more_options: &'a [String],
    pub(super) statistics: Option<String>,
    pub(super) temporary: bool,
    /// Further names in the command line.
    pub(super) names: &'a [(&'a str, String)],
    pub(super) labels: &'a [(String, String)],
    /// For a result, the tasks of its method.
    pub(super) chain: Vec<String>,
    pub(super) cpu_limit: Option<u64>,
}

impl Planner<'_> {
    /// Fills in the command line of a step and adds the task, unless the plan has it already.
    pub(super) fn add(&mut self, run: &Run<'_>, step: &str, parts: Parts<'_>) -> anyhow::Result<()> {
        let nothing = crate::Step::default();
        let declared = run.experiment.stages.get(step).unwrap_or(&nothing);
        let stage = declared.program.as_deref().unwrap_or(step);
        let program = self.programs.get(stage)?;
        let mut options =
            run.point.fill(run.experiment, &declared.options).with_context(|| format!("stages.{step}"))?;
        let more = run.point.fill(run.experiment, parts.more_options);
        options.extend(more.with_context(|| format!("graphs, options of {step}"))?);
        let mut files = program.files.clone();
        let statistics = parts.statistics.iter().filter(|_| !program.statistics.is_empty());
        let statistics: Vec<String> = statistics.cloned().collect();
        let template =
            program.argv.iter().chain(program.statistics.iter().filter(|_| !statistics.is_empty()));
        let mut argv = Vec::new();
        for word in template {
            match word.as_str() {
                "{options}" => argv.extend(options.iter().cloned()),
                "{labels}" => {
                    let pairs = parts.labels.iter().map(|(name, value)| format!("{name}={value}"));
                    argv.extend(pairs.flat_map(|label| ["--label".to_owned(), label]));
                }
                "{input}" => argv.extend(parts.inputs.iter().cloned()),
                word => argv.push(replace(word, |name| {
                    Ok(match name {
                        "program" => program.path.clone(),
                        "input" => parts.inputs.join(" "),
                        "output" => parts.output.clone(),
                        "statistics" => statistics.first().cloned().unwrap_or_default(),
                        other => match parts.names.iter().find(|(name, _)| *name == other) {
                            Some((_, value)) => value.clone(),
                            // The program is a script that calls another stage, so the result depends on that stage's file too.
                            None if let Ok(other) = self.programs.get(other) => {
                                let file = locate(&other.path)?.to_string_lossy().into_owned();
                                files.push(file.clone());
                                file
                            }
                            None => bail!("the command line of stage \"{stage}\" uses \"{{{other}}}\", which this stage does not have"),
                        },
                    })
                })?),
            }
        }
        let task = Task {
            id: parts.output.clone(),
            stage: step.to_owned(),
            group: parts.group.to_owned(),
            argv,
            inputs: parts.inputs.iter().cloned().chain(parts.more_inputs).collect(),
            outputs: vec![parts.output],
            statistics,
            files,
            temporary: parts.temporary,
            cpu_limit: parts.cpu_limit,
            labels: parts.labels.iter().map(|(name, value)| (name.clone(), label_value(value))).collect(),
            chain: parts.chain,
            digest: String::new(),
        };
        match self.known.get(&task.id) {
            Some(&place) if self.plan.tasks[place] == task => {}
            Some(_) => bail!(
                "{}: two runs would write it with different arguments; a parameter is missing from [parameters]",
                task.id
            ),
            None => {
                self.known.insert(task.id.clone(), self.plan.tasks.len());
                self.plan.tasks.push(task);
            }
        }
        Ok(())
    }
}

/// Converts a label as posecut-evaluate does: numbers stay numbers, everything else is text.
fn label_value(text: &str) -> Value {
    text.parse::<u64>().map_or_else(|_| Value::from(text), Value::from)
}

//! The steps of a run: from a session, a given or a drawn graph to the graph of a method.

use std::path::Path;

use super::{Folders, Parts, Planner, Run};
use crate::Keep;
use crate::drawn::Drawn;
use crate::graphs::GraphFile;

impl Planner<'_> {
    /// Adds the tasks for a session's graph, with the simulation if the session is not real.
    pub(super) fn add_session(
        &mut self,
        run: &Run<'_>,
        session: &str,
        data: &str,
        folder: &str,
    ) -> anyhow::Result<String> {
        if self.source.simulates(run.experiment) {
            let output = data.to_owned();
            self.add(run, "simulate", Parts { group: data, output, ..Parts::default() })?;
        }
        let output = format!("{folder}/session.jsonl");
        self.add(
            run,
            "ingest",
            Parts {
                group: folder,
                inputs: &[data.to_owned()],
                output: output.clone(),
                more_inputs: self.source.beside(run.experiment, session).into_iter().collect(),
                statistics: Some(format!("{folder}/ingest.stats.json")),
                ..Parts::default()
            },
        )?;
        Ok(output)
    }

    pub(super) fn add_construction(
        &mut self,
        run: &Run<'_>,
        sessions: &[String],
        folder: &str,
    ) -> anyhow::Result<String> {
        let all = run.experiment.keep == Keep::All;
        let output = format!("{folder}/graph.jsonl");
        self.add(
            run,
            "construct",
            Parts {
                group: folder,
                inputs: sessions,
                output: output.clone(),
                statistics: all.then(|| format!("{folder}/construct.stats.json")),
                temporary: !all,
                names: &[("seed", run.seed.to_string())],
                ..Parts::default()
            },
        )?;
        Ok(output)
    }

    /// Adds the tasks that convert and label a given graph.
    pub(super) fn add_given(
        &mut self,
        run: &Run<'_>,
        file: &GraphFile,
        folder: &str,
    ) -> anyhow::Result<String> {
        let all = run.experiment.keep == Keep::All;
        let converted = format!("{folder}/converted.jsonl");
        self.add(
            run,
            "convert",
            Parts {
                group: folder,
                inputs: &file.files,
                output: converted.clone(),
                more_options: &file.convert,
                statistics: all.then(|| format!("{folder}/convert.stats.json")),
                temporary: !all,
                ..Parts::default()
            },
        )?;
        let output = format!("{folder}/graph.jsonl");
        self.add(
            run,
            "label",
            Parts {
                group: folder,
                inputs: &[converted],
                output: output.clone(),
                // The result depends on files of labels too.
                more_inputs: file.label.iter().filter(|word| Path::new(word).is_file()).cloned().collect(),
                more_options: &file.label,
                statistics: all.then(|| format!("{folder}/label.stats.json")),
                temporary: !all,
                ..Parts::default()
            },
        )?;
        Ok(output)
    }

    /// Adds the task that draws a graph.
    pub(super) fn add_drawn(&mut self, run: &Run<'_>, drawn: &Drawn, folder: &str) -> anyhow::Result<String> {
        let all = run.experiment.keep == Keep::All;
        let output = format!("{folder}/graph.jsonl");
        self.add(
            run,
            "simulate-graph",
            Parts {
                group: folder,
                output: output.clone(),
                more_options: &drawn.words(),
                statistics: all.then(|| format!("{folder}/simulate-graph.stats.json")),
                temporary: !all,
                names: &[("seed", run.seed.to_string())],
                ..Parts::default()
            },
        )?;
        Ok(output)
    }

    /// Adds the rejection chain of a method and its optimisation. Returns the optimised graph and the tasks of the chain.
    pub(super) fn add_method(
        &mut self,
        run: &Run<'_>,
        method: &str,
        folders: &Folders<'_>,
    ) -> anyhow::Result<(String, Vec<String>)> {
        let experiment = run.experiment;
        let chain = experiment.chain(method)?;
        // The reference has no limit, because without it no method has a result.
        let reference = experiment.chain(&experiment.reference)?;
        let limit = |steps: &[String]| experiment.cpu_limit.filter(|_| !reference.starts_with(steps));
        let mut tasks = Vec::new();
        let mut graph = folders.graph.to_owned();
        for length in 1..=chain.len() {
            // A prefix of the chain that is a method by itself gets that method's name, so it runs once for both.
            let name = experiment
                .chains
                .iter()
                .find(|(_, other)| other.as_slice() == &chain[..length])
                .map_or_else(|| chain[..length].join("~"), |(name, _)| name.clone());
            let output = format!("{}/{name}.jsonl", folders.methods);
            self.add(
                run,
                &chain[length - 1],
                Parts {
                    group: folders.group,
                    inputs: &[graph],
                    output: output.clone(),
                    statistics: folders.all.then(|| format!("{}/{name}.stats.json", folders.methods)),
                    temporary: !folders.all,
                    cpu_limit: limit(&chain[..length]),
                    ..Parts::default()
                },
            )?;
            tasks.push(output.clone());
            graph = output;
        }
        let output = format!("{}/{method}.optimized.jsonl", folders.methods);
        self.add(
            run,
            "optimize",
            Parts {
                group: folders.group,
                inputs: &[graph],
                output: output.clone(),
                statistics: folders.all.then(|| format!("{}/{method}.optimize.stats.json", folders.methods)),
                temporary: !folders.all,
                cpu_limit: experiment.cpu_limit.filter(|_| reference != chain),
                ..Parts::default()
            },
        )?;
        Ok((output, tasks))
    }
}

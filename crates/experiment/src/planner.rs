//! From declarations to a plan.

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

use anyhow::{Context as _, bail};

use crate::parameters::{replace, used};
use crate::{Experiment, Grid, Keep, Plan, Point, Programs, Task};

/// Where sessions come from and results go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// A folder of NCLT sessions, as `DATE/` or `DATE_sen.tar.gz`; simulated sessions unless given.
    pub nclt: Option<PathBuf>,
    /// Where simulated sessions go.
    pub simulated: PathBuf,
    /// Where results go.
    pub results: PathBuf,
}

impl Source {
    /// The file or folder of a session, if it is there or can be made.
    fn session(&self, name: &str) -> Option<String> {
        let text = |path: PathBuf| path.to_string_lossy().into_owned();
        match &self.nclt {
            None => Some(text(self.simulated.join(name))),
            Some(nclt) => [nclt.join(name), nclt.join(format!("{name}_sen.tar.gz"))]
                .into_iter()
                .find(|path| path.exists())
                .map(text),
        }
    }

    /// The ground truth beside an archive, which its session's graph depends on too.
    fn beside(&self, name: &str) -> Option<String> {
        let path = self.nclt.as_ref()?.join(format!("groundtruth_{name}.csv"));
        path.is_file().then(|| path.to_string_lossy().into_owned())
    }
}

/// Expands experiments to tasks. Sessions without data are left out and returned by name.
pub fn plan(
    experiments: &[Experiment],
    programs: &Programs,
    source: &Source,
) -> anyhow::Result<(Plan, Vec<String>)> {
    let mut planner = Planner { programs, source, plan: Plan::default(), known: HashMap::new() };
    let mut missing = BTreeSet::new();
    for experiment in experiments {
        let single = [Grid::default()];
        let grids = if experiment.grids.is_empty() { &single[..] } else { &experiment.grids };
        for grid in grids {
            let sessions = grid.sessions.as_ref().unwrap_or(&experiment.sessions);
            for session in sessions.iter().filter(|session| !grid.except.contains(session)) {
                let Some(data) = source.session(session) else {
                    missing.insert(session.clone());
                    continue;
                };
                for point in Point::all(experiment, grid) {
                    for seed in 1..=grid.seeds.unwrap_or(experiment.seeds) {
                        let methods = grid.methods.as_ref().unwrap_or(&experiment.methods);
                        let run = Run { experiment, session, data: &data, point: &point, seed, methods };
                        planner.add_run(&run).with_context(|| format!("experiment {}", experiment.name))?;
                    }
                }
            }
        }
    }
    planner.plan.seal()?;
    Ok((planner.plan, missing.into_iter().collect()))
}

/// One session with one seed at one point of the grid.
struct Run<'a> {
    experiment: &'a Experiment,
    session: &'a str,
    data: &'a str,
    point: &'a Point,
    seed: u64,
    methods: &'a [String],
}

struct Planner<'a> {
    programs: &'a Programs,
    source: &'a Source,
    plan: Plan,
    known: HashMap<String, usize>,
}

/// What a task is made of besides its step.
struct Parts<'a> {
    group: &'a str,
    /// What `{input}` stands for.
    input: &'a str,
    output: String,
    more_inputs: Vec<String>,
    statistics: Option<String>,
    temporary: bool,
    /// Further names in the command line.
    names: &'a [(&'a str, String)],
    labels: &'a [String],
}

impl Planner<'_> {
    fn add_run(&mut self, run: &Run<'_>) -> anyhow::Result<()> {
        let experiment = run.experiment;
        let label = match self.source.nclt {
            Some(_) => experiment.name.clone(),
            None => format!("{}-simulated", experiment.name),
        };
        // A folder level for each set of parameters that first matter there.
        let options = |steps: &[&str]| {
            let steps: Vec<&str> = steps.to_vec();
            used(
                experiment,
                steps
                    .into_iter()
                    .filter_map(|step| experiment.stages.get(step))
                    .flat_map(|step| &step.options),
            )
        };
        let of_session = options(&["simulate", "ingest"]);
        let of_graph: BTreeSet<String> = options(&["construct"]).difference(&of_session).cloned().collect();
        let of_methods: BTreeSet<String> = experiment
            .parameters
            .keys()
            .filter(|name| !of_session.contains(*name) && !of_graph.contains(*name))
            .cloned()
            .collect();
        let join = |folder: &str, part: &str| {
            if part.is_empty() { folder.to_owned() } else { format!("{folder}/{part}") }
        };
        let results = self.source.results.to_string_lossy().into_owned();
        let session_folder =
            join(&format!("{results}/{label}/{}", run.session), &run.point.folder(&of_session));
        let graph_folder = join(&join(&session_folder, &run.point.folder(&of_graph)), &run.seed.to_string());
        let method_folder = join(&graph_folder, &run.point.folder(&of_methods));

        self.add_simulation(run)?;
        let session = format!("{session_folder}/session.jsonl");
        self.add(
            run,
            "ingest",
            &Parts {
                group: &session_folder,
                input: run.data,
                output: session.clone(),
                more_inputs: self.source.beside(run.session).into_iter().collect(),
                statistics: Some(format!("{session_folder}/ingest.stats.json")),
                temporary: false,
                names: &[],
                labels: &[],
            },
        )?;
        let all = experiment.keep == Keep::All;
        let graph = format!("{graph_folder}/graph.jsonl");
        self.add(
            run,
            "construct",
            &Parts {
                group: &graph_folder,
                input: &session,
                output: graph.clone(),
                more_inputs: Vec::new(),
                statistics: all.then(|| format!("{graph_folder}/construct.stats.json")),
                temporary: !all,
                names: &[("seed", run.seed.to_string())],
                labels: &[],
            },
        )?;
        let folders = Folders { group: &graph_folder, methods: &method_folder, graph: &graph, all };
        let reference = self.add_method(run, &experiment.reference, &folders)?;
        for method in run.methods {
            let estimate = self.add_method(run, method, &folders)?;
            let mut labels = vec![
                format!("pipeline={label}"),
                format!("session={}", run.session),
                format!("seed={}", run.seed),
                format!("method={method}"),
            ];
            labels.extend(run.point.0.iter().map(|(name, value)| format!("{name}={value}")));
            self.add(
                run,
                "evaluate",
                &Parts {
                    group: &graph_folder,
                    input: &estimate,
                    output: format!("{method_folder}/{method}.result.json"),
                    more_inputs: vec![reference.clone()],
                    statistics: all.then(|| format!("{method_folder}/{method}.evaluate.stats.json")),
                    temporary: false,
                    names: &[("reference", reference.clone())],
                    labels: &labels,
                },
            )?;
        }
        Ok(())
    }

    fn add_simulation(&mut self, run: &Run<'_>) -> anyhow::Result<()> {
        if self.source.nclt.is_some() {
            return Ok(());
        }
        self.add(
            run,
            "simulate",
            &Parts {
                group: run.data,
                input: "",
                output: run.data.to_owned(),
                more_inputs: Vec::new(),
                statistics: None,
                temporary: false,
                names: &[],
                labels: &[],
            },
        )
    }

    /// The rejection chain of a method and its optimisation; returns the optimised graph.
    fn add_method(&mut self, run: &Run<'_>, method: &str, folders: &Folders<'_>) -> anyhow::Result<String> {
        let experiment = run.experiment;
        let chain = experiment.chain(method)?;
        let mut graph = folders.graph.to_owned();
        for length in 1..=chain.len() {
            // A prefix of the chain that is a method itself has that method's name, and runs once for both.
            let name = experiment
                .chains
                .iter()
                .find(|(_, other)| other.as_slice() == &chain[..length])
                .map_or_else(|| chain[..length].join("~"), |(name, _)| name.clone());
            let output = format!("{}/{name}.jsonl", folders.methods);
            self.add(
                run,
                &chain[length - 1],
                &Parts {
                    group: folders.group,
                    input: &graph,
                    output: output.clone(),
                    more_inputs: Vec::new(),
                    statistics: folders.all.then(|| format!("{}/{name}.stats.json", folders.methods)),
                    temporary: !folders.all,
                    names: &[],
                    labels: &[],
                },
            )?;
            graph = output;
        }
        let output = format!("{}/{method}.optimized.jsonl", folders.methods);
        self.add(
            run,
            "optimize",
            &Parts {
                group: folders.group,
                input: &graph,
                output: output.clone(),
                more_inputs: Vec::new(),
                statistics: folders.all.then(|| format!("{}/{method}.optimize.stats.json", folders.methods)),
                temporary: !folders.all,
                names: &[],
                labels: &[],
            },
        )?;
        Ok(output)
    }

    fn add(&mut self, run: &Run<'_>, step: &str, parts: &Parts<'_>) -> anyhow::Result<()> {
        let nothing = crate::Step::default();
        let declared = run.experiment.stages.get(step).unwrap_or(&nothing);
        let stage = declared.program.as_deref().unwrap_or(step);
        let program = self.programs.get(stage)?;
        let options =
            run.point.fill(run.experiment, &declared.options).with_context(|| format!("stages.{step}"))?;
        let statistics = parts.statistics.iter().filter(|_| !program.statistics.is_empty());
        let statistics: Vec<String> = statistics.cloned().collect();
        let template =
            program.argv.iter().chain(program.statistics.iter().filter(|_| !statistics.is_empty()));
        let mut argv = Vec::new();
        for word in template {
            match word.as_str() {
                "{options}" => argv.extend(options.iter().cloned()),
                "{labels}" => {
                    argv.extend(parts.labels.iter().flat_map(|label| ["--label".to_owned(), label.clone()]));
                }
                word => argv.push(replace(word, |name| {
                    Ok(match name {
                        "program" => program.path.clone(),
                        "input" => parts.input.to_owned(),
                        "output" => parts.output.clone(),
                        "statistics" => statistics.first().cloned().unwrap_or_default(),
                        other => match parts.names.iter().find(|(name, _)| *name == other) {
                            Some((_, value)) => value.clone(),
                            None => bail!("the command line of stage \"{stage}\" names \"{{{other}}}\", which this stage does not have"),
                        },
                    })
                })?),
            }
        }
        let inputs = std::iter::once(parts.input.to_owned())
            .filter(|input| !input.is_empty())
            .chain(parts.more_inputs.iter().cloned())
            .collect();
        let task = Task {
            id: parts.output.clone(),
            stage: step.to_owned(),
            group: parts.group.to_owned(),
            argv,
            inputs,
            outputs: vec![parts.output.clone()],
            statistics,
            files: program.files.clone(),
            temporary: parts.temporary,
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

/// Where a method's files go.
struct Folders<'a> {
    group: &'a str,
    methods: &'a str,
    graph: &'a str,
    all: bool,
}

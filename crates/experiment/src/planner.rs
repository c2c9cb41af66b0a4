//! From declarations to a plan.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use serde_json::Value;

use crate::graphs::GraphFile;
use crate::items::{Item, Kind, items, matches};
use crate::parameters::{replace, used};
use crate::programs::locate;
use crate::{Experiment, Grid, Half, Keep, Plan, Point, Programs, Task};

/// Where sessions and graphs come from and results go.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// A folder of NCLT sessions, as `DATE/` or `DATE_sen.tar.gz`; simulated sessions unless given.
    pub nclt: Option<PathBuf>,
    /// The folder of given graphs, and of real sessions in its folder `nclt`.
    pub data: Option<PathBuf>,
    /// Only the items of this half.
    pub half: Option<Half>,
    /// Where simulated sessions go.
    pub simulated: PathBuf,
    /// Where results go.
    pub results: PathBuf,
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
        let named = || format!("experiment {}", experiment.name);
        let items = items(experiment, source, &mut missing).with_context(named)?;
        let single = [Grid::default()];
        let grids = if experiment.grids.is_empty() { &single[..] } else { &experiment.grids };
        for grid in grids {
            for item in &items {
                if !runs(experiment, grid, item).with_context(named)? {
                    continue;
                }
                // Construction draws random numbers; a given graph is what it is.
                let seeds = match item.kind {
                    Kind::Sessions(_) => grid.seeds.unwrap_or(experiment.seeds),
                    Kind::Graph(_) => 1,
                };
                for point in Point::all(experiment, grid) {
                    for seed in 1..=seeds {
                        let methods = grid.methods.as_ref().unwrap_or(&experiment.methods);
                        let run = Run { experiment, item, point: &point, seed, methods };
                        planner.add_run(&run).with_context(named)?;
                    }
                }
            }
        }
    }
    planner.plan.seal()?;
    Ok((planner.plan, missing.into_iter().collect()))
}

/// Whether a block of the grid runs on an item.
fn runs(experiment: &Experiment, grid: &Grid, item: &Item) -> anyhow::Result<bool> {
    let listed = match &grid.sessions {
        Some(names) => matches(names, &item.name)?,
        None if experiment.only => matches(&experiment.sessions, &item.name)?,
        None => matches!(item.kind, Kind::Graph(_)) || experiment.sessions.contains(&item.name),
    };
    Ok(listed && !matches(&grid.except, &item.name)?)
}

/// One session or graph with one seed at one point of the grid.
struct Run<'a> {
    experiment: &'a Experiment,
    item: &'a Item,
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
#[derive(Default)]
struct Parts<'a> {
    group: &'a str,
    /// What `{input}` stands for; several words where a stage reads several files.
    inputs: &'a [String],
    output: String,
    /// Read too, and not named by `{input}`.
    more_inputs: Vec<String>,
    /// After the declared options.
    more_options: &'a [String],
    statistics: Option<String>,
    temporary: bool,
    /// Further names in the command line.
    names: &'a [(&'a str, String)],
    labels: &'a [(String, String)],
    /// The tasks of the method, of a result.
    chain: Vec<String>,
    cpu_limit: Option<u64>,
}

impl Planner<'_> {
    fn add_run(&mut self, run: &Run<'_>) -> anyhow::Result<()> {
        let experiment = run.experiment;
        let name = &run.item.name;
        let is_graph = matches!(run.item.kind, Kind::Graph(_));
        let label = if is_graph || experiment.source.is_some() || !self.source.simulates(experiment) {
            experiment.name.clone()
        } else {
            format!("{}-simulated", experiment.name)
        };
        // Parameters say where a file goes: those of a session, of a graph, of a method.
        let options = |steps: &[&str]| -> BTreeSet<String> {
            let words = steps.iter().filter_map(|step| experiment.stages.get(*step));
            used(experiment, words.flat_map(|step| step.options.iter()))
        };
        let (of_session, of_graph) = match &run.item.kind {
            Kind::Sessions(_) => (options(&["simulate", "ingest"]), options(&["construct"])),
            Kind::Graph(graph) => {
                let mut names = options(&["convert", "label"]);
                names.extend(used(experiment, graph.convert.iter().chain(&graph.label)));
                (names, BTreeSet::new())
            }
        };
        let of_graph: BTreeSet<String> = of_graph.difference(&of_session).cloned().collect();
        let of_methods: BTreeSet<String> = experiment
            .parameters
            .keys()
            .filter(|name| !of_session.contains(*name) && !of_graph.contains(*name))
            .cloned()
            .collect();
        let results = self.source.results.to_string_lossy().into_owned();
        let session_folder =
            |session: &str| join(&format!("{results}/{label}/{session}"), &run.point.folder(&of_session));
        let all = experiment.keep == Keep::All;
        let graph_folder = join(&session_folder(name), &run.point.folder(&of_graph));
        let (graph_folder, graph) = match &run.item.kind {
            Kind::Sessions(sessions) => {
                let graphs = sessions
                    .iter()
                    .map(|(session, data)| self.add_session(run, session, data, &session_folder(session)))
                    .collect::<anyhow::Result<Vec<String>>>()?;
                let folder = join(&graph_folder, &run.seed.to_string());
                let graph = self.add_construction(run, &graphs, &folder)?;
                (folder, graph)
            }
            Kind::Graph(file) => {
                let graph = self.add_given(run, file, &graph_folder)?;
                (graph_folder, graph)
            }
        };
        let method_folder = join(&graph_folder, &run.point.folder(&of_methods));
        let folders = Folders { group: &graph_folder, methods: &method_folder, graph: &graph, all };
        let (reference, _) = self.add_method(run, &experiment.reference, &folders)?;
        for method in run.methods {
            let (estimate, chain) = self.add_method(run, method, &folders)?;
            self.add(
                run,
                "evaluate",
                Parts {
                    group: &graph_folder,
                    inputs: &[estimate],
                    output: format!("{method_folder}/{method}.result.json"),
                    more_inputs: vec![reference.clone()],
                    statistics: all.then(|| format!("{method_folder}/{method}.evaluate.stats.json")),
                    names: &[("reference", reference.clone())],
                    labels: &labels(run, &label, method),
                    chain,
                    ..Parts::default()
                },
            )?;
        }
        Ok(())
    }

    /// A session's graph, simulated first where it is not real.
    fn add_session(
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

    fn add_construction(
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

    /// A given graph, converted and labelled.
    fn add_given(&mut self, run: &Run<'_>, file: &GraphFile, folder: &str) -> anyhow::Result<String> {
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
                // Files of labels decide what comes out, too.
                more_inputs: file.label.iter().filter(|word| Path::new(word).is_file()).cloned().collect(),
                more_options: &file.label,
                statistics: all.then(|| format!("{folder}/label.stats.json")),
                temporary: !all,
                ..Parts::default()
            },
        )?;
        Ok(output)
    }

    /// The rejection chain of a method and its optimisation; returns the optimised graph and the tasks of the chain.
    fn add_method(
        &mut self,
        run: &Run<'_>,
        method: &str,
        folders: &Folders<'_>,
    ) -> anyhow::Result<(String, Vec<String>)> {
        let experiment = run.experiment;
        let chain = experiment.chain(method)?;
        // Without the reference there is no result at all, so it has no limit.
        let reference = experiment.chain(&experiment.reference)?;
        let limit = |steps: &[String]| experiment.cpu_limit.filter(|_| !reference.starts_with(steps));
        let mut tasks = Vec::new();
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

    fn add(&mut self, run: &Run<'_>, step: &str, parts: Parts<'_>) -> anyhow::Result<()> {
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
                            // A script that calls another stage: what that one is decides what comes out.
                            None if let Ok(other) = self.programs.get(other) => {
                                let file = locate(&other.path)?.to_string_lossy().into_owned();
                                files.push(file.clone());
                                file
                            }
                            None => bail!("the command line of stage \"{stage}\" names \"{{{other}}}\", which this stage does not have"),
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

fn join(folder: &str, part: &str) -> String {
    if part.is_empty() { folder.to_owned() } else { format!("{folder}/{part}") }
}

/// What a result is called by.
fn labels(run: &Run<'_>, pipeline: &str, method: &str) -> Vec<(String, String)> {
    let mut labels = vec![("pipeline", pipeline.to_owned())];
    if let Some(family) = &run.experiment.family {
        labels.push(("family", family.clone()));
        labels.extend(run.item.half.map(|half| ("half", half.name().to_owned())));
        labels.push(("cluster", run.item.cluster.clone()));
    }
    labels.push(("session", run.item.name.clone()));
    labels.push(("seed", run.seed.to_string()));
    labels.push(("method", method.to_owned()));
    let parameters = run.point.0.iter().map(|(name, value)| (name.clone(), value.clone()));
    labels.into_iter().map(|(name, value)| (name.to_owned(), value)).chain(parameters).collect()
}

/// As posecut-evaluate writes labels: numbers stay numbers, everything else is text.
fn label_value(text: &str) -> Value {
    text.parse::<u64>().map_or_else(|_| Value::from(text), Value::from)
}

/// Where a method's files go.
struct Folders<'a> {
    group: &'a str,
    methods: &'a str,
    graph: &'a str,
    all: bool,
}

//! Expands declarations to a plan.

use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;

use anyhow::Context as _;

use crate::items::{Item, Kind, items, matches};
use crate::parameters::used;
use crate::size::Size;
use crate::{Experiment, Grid, Half, Keep, Plan, Point, Programs, held};

mod steps;
mod task;

use task::Parts;

/// The folders of sessions, graphs and results.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Source {
    /// The folder of NCLT sessions, as `DATE/` or `DATE_sen.tar.gz`. Without it, sessions are simulated.
    pub nclt: Option<PathBuf>,
    /// The folder of given graphs. Its folder `nclt` holds real sessions.
    pub data: Option<PathBuf>,
    /// Run only the items or seeds of this half.
    pub half: Option<Half>,
    /// The folder for simulated sessions.
    pub simulated: PathBuf,
    /// The folder for results.
    pub results: PathBuf,
}

/// Expands experiments to tasks. Sessions without data are left out, and their names are returned.
pub fn plan(
    experiments: &[Experiment],
    programs: &Programs,
    source: &Source,
) -> anyhow::Result<(Plan, Vec<String>)> {
    let mut planner = Planner { programs, source, plan: Plan::default(), known: HashMap::new() };
    let mut missing = BTreeSet::new();
    let mut size = Size::default();
    for experiment in experiments {
        let named = || format!("experiment {}", experiment.name);
        let items = items(experiment, source, &mut missing).with_context(named)?;
        let single = [Grid::default()];
        let grids = if experiment.grids.is_empty() { &single[..] } else { &experiment.grids };
        for grid in grids {
            let methods = grid.methods.as_ref().unwrap_or(&experiment.methods);
            for item in &items {
                if !runs(experiment, grid, item).with_context(named)? {
                    continue;
                }
                // Nothing is drawn for a given graph, so it needs one seed.
                let seeds = match item.kind {
                    Kind::Sessions(_) | Kind::Drawn(_) => grid.seeds.unwrap_or(experiment.seeds),
                    Kind::Graph(_) => 1,
                };
                size.add(grid, seeds, methods.len()).with_context(named)?;
                for point in Point::all(experiment, grid) {
                    for seed in 1..=seeds {
                        let half = item.half_with(experiment, seed).with_context(named)?;
                        if source.half.is_some() && half != source.half {
                            continue;
                        }
                        let run = Run { experiment, item, point: &point, seed, half, methods };
                        planner.add_run(&run).with_context(named)?;
                    }
                }
            }
        }
    }
    held::check(&planner.plan, source)?;
    planner.plan.seal()?;
    Ok((planner.plan, missing.into_iter().collect()))
}

/// Whether a block of the grid runs on an item.
fn runs(experiment: &Experiment, grid: &Grid, item: &Item) -> anyhow::Result<bool> {
    let listed = match &grid.sessions {
        Some(names) => matches(names, &item.name)?,
        None if experiment.only => matches(&experiment.sessions, &item.name)?,
        None => item.is_graph() || experiment.sessions.contains(&item.name),
    };
    Ok(listed && !matches(&grid.except, &item.name)?)
}

/// One session or graph, given or drawn, with one seed at one point of the grid.
struct Run<'a> {
    experiment: &'a Experiment,
    item: &'a Item,
    point: &'a Point,
    seed: u64,
    half: Option<Half>,
    methods: &'a [String],
}

struct Planner<'a> {
    programs: &'a Programs,
    source: &'a Source,
    plan: Plan,
    known: HashMap<String, usize>,
}

impl Planner<'_> {
    fn add_run(&mut self, run: &Run<'_>) -> anyhow::Result<()> {
        let experiment = run.experiment;
        let name = &run.item.name;
        let label =
            if run.item.is_graph() || experiment.source.is_some() || !self.source.simulates(experiment) {
                experiment.name.clone()
            } else {
                format!("{}-simulated", experiment.name)
            };
        let Placed { session: of_session, graph: of_graph, methods: of_methods } = Placed::of(run);
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
            Kind::Drawn(drawn) => {
                let folder = join(&graph_folder, &run.seed.to_string());
                let graph = self.add_drawn(run, drawn, &folder)?;
                (folder, graph)
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
                    labels: &self.labels(run, &label, method)?,
                    chain,
                    ..Parts::default()
                },
            )?;
        }
        Ok(())
    }

    /// The labels of a result.
    fn labels(&self, run: &Run<'_>, pipeline: &str, method: &str) -> anyhow::Result<Vec<(String, String)>> {
        let mut labels = vec![("pipeline", pipeline.to_owned())];
        if let Some(family) = &run.experiment.family {
            labels.push(("family", family.clone()));
            labels.extend(run.half.map(|half| ("half", half.name().to_owned())));
            labels.push(("cluster", run.item.cluster_with(run.seed)));
        }
        labels.push(("session", run.item.name.clone()));
        labels.push(("seed", run.seed.to_string()));
        labels.push(("method", method.to_owned()));
        labels.extend(self.replaced(run, method)?.map(|replaced| ("replaced", replaced)));
        let parameters = run.point.0.iter().map(|(name, value)| (name.clone(), value.clone()));
        Ok(labels.into_iter().map(|(name, value)| (name.to_owned(), value)).chain(parameters).collect())
    }

    /// The programs that replace stages on the way to the result of a method, so that its row in a table names them.
    fn replaced(&self, run: &Run<'_>, method: &str) -> anyhow::Result<Option<String>> {
        let before: &[&str] = match run.item.kind {
            Kind::Sessions(_) => &["simulate", "ingest", "construct"],
            Kind::Graph(_) => &["convert", "label"],
            Kind::Drawn(_) => &["simulate-graph"],
        };
        let experiment = run.experiment;
        let chain = experiment.chain(method)?;
        let program = |step: &'_ String| {
            experiment.stages.get(step).and_then(|step| step.program.clone()).unwrap_or_else(|| step.clone())
        };
        let of_chain: Vec<String> = chain.iter().map(program).collect();
        let stages = of_chain.iter().map(String::as_str).chain(before.iter().copied());
        Ok(self.programs.replaced(stages.chain(["optimize", "evaluate"])))
    }
}

/// The parameters of a run, by the files whose paths they determine: those of a session, a graph or a method.
struct Placed {
    session: BTreeSet<String>,
    graph: BTreeSet<String>,
    methods: BTreeSet<String>,
}

impl Placed {
    fn of(run: &Run<'_>) -> Self {
        let experiment = run.experiment;
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
            Kind::Drawn(drawn) => {
                let mut names = options(&["simulate-graph"]);
                names.extend(used(experiment, drawn.words().iter()));
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
        Self { session: of_session, graph: of_graph, methods: of_methods }
    }
}

fn join(folder: &str, part: &str) -> String {
    if part.is_empty() { folder.to_owned() } else { format!("{folder}/{part}") }
}

/// The folders for a method's files.
struct Folders<'a> {
    group: &'a str,
    methods: &'a str,
    graph: &'a str,
    all: bool,
}

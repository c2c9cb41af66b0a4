//! The items that an experiment runs on: sessions, joined sessions and given graphs.

use std::collections::BTreeSet;
use std::path::PathBuf;

use anyhow::{Context as _, bail};

use crate::drawn::Drawn;
use crate::graphs::GraphFile;
use crate::halves::any;
use crate::names::check;
use crate::{Experiment, Half, Halves, Origin, Source};

/// One session, several joined sessions (`A+B`), one given graph, or the graphs that are drawn with one set of options.
pub(crate) struct Item {
    pub(crate) name: String,
    /// The unit of the bootstrap.
    pub(crate) cluster: String,
    /// The half of the item, if halves are defined by names.
    half: Option<Half>,
    pub(crate) kind: Kind,
}

impl Item {
    /// Whether the item is a graph, given or drawn, and not made of sessions.
    pub(crate) fn is_graph(&self) -> bool {
        !matches!(self.kind, Kind::Sessions(_))
    }

    /// The unit of the bootstrap that the run with this seed belongs to. Every seed draws another graph.
    pub(crate) fn cluster_with(&self, seed: u64) -> String {
        match self.kind {
            Kind::Drawn(_) => format!("{}-{seed}", self.cluster),
            Kind::Sessions(_) | Kind::Graph(_) => self.cluster.clone(),
        }
    }

    /// The half of a run with this seed, if the experiment has halves.
    pub(crate) fn half_with(&self, experiment: &Experiment, seed: u64) -> anyhow::Result<Option<Half>> {
        match &experiment.halves {
            Some(halves) if halves.by_seed() => halves.of_seed(seed).map(Some),
            _ => Ok(self.half),
        }
    }
}

/// The source of an item.
pub(crate) enum Kind {
    /// Names of the sessions and their data.
    Sessions(Vec<(String, String)>),
    Graph(GraphFile),
    Drawn(Drawn),
}

impl Source {
    /// The folder of real sessions, if the experiment uses real sessions.
    fn nclt(&self, experiment: &Experiment) -> Option<PathBuf> {
        match experiment.source {
            Some(Origin::Simulated) => None,
            Some(Origin::Nclt) => {
                let beside = self.data.as_ref().map(|data| data.join("nclt"));
                Some(self.nclt.clone().or(beside).unwrap_or_else(|| PathBuf::from("data/nclt")))
            }
            None => self.nclt.clone(),
        }
    }

    /// Whether the sessions of an experiment are simulated.
    pub(crate) fn simulates(&self, experiment: &Experiment) -> bool {
        self.nclt(experiment).is_none()
    }

    /// The file or folder of a session, if it exists or can be simulated.
    fn session(&self, experiment: &Experiment, name: &str) -> Option<String> {
        let text = |path: PathBuf| path.to_string_lossy().into_owned();
        match self.nclt(experiment) {
            None => Some(text(self.simulated.join(name))),
            Some(nclt) => [nclt.join(name), nclt.join(format!("{name}_sen.tar.gz"))]
                .into_iter()
                .find(|path| path.exists())
                .map(text),
        }
    }

    /// The file of ground truth beside an archive. The graph of the session depends on it too.
    pub(crate) fn beside(&self, experiment: &Experiment, name: &str) -> Option<String> {
        let path = self.nclt(experiment)?.join(format!("groundtruth_{name}.csv"));
        path.is_file().then(|| path.to_string_lossy().into_owned())
    }
}

/// All items of an experiment, of both halves. Sessions without data are left out and recorded.
pub(crate) fn items(
    experiment: &Experiment,
    source: &Source,
    missing: &mut BTreeSet<String>,
) -> anyhow::Result<Vec<Item>> {
    let by_seed = experiment.halves.as_ref().is_some_and(Halves::by_seed);
    if by_seed && !experiment.graphs.is_empty() {
        bail!("[halves]: given graphs have only one seed; define the halves by graph names");
    }
    let mut found = given_graphs(experiment, source)?;
    found.extend(experiment.drawn.iter().map(|drawn| Item {
        name: drawn.name.clone(),
        cluster: drawn.name.clone(),
        half: None,
        kind: Kind::Drawn(drawn.clone()),
    }));
    add_sessions(experiment, source, &mut found, missing)?;
    found.iter().try_for_each(|item| check("session or graph", &item.name))?;
    let mut seen = BTreeSet::new();
    if let Some(twice) = found.iter().find(|item| !seen.insert(&item.name)) {
        bail!(
            "two graphs are called \"{}\"; give one of the [[graphs]] or [[drawn]] another name, such as name = \"mine_{{stem}}\"",
            twice.name
        );
    }
    if by_seed
        && !found.iter().all(Item::is_graph)
        && experiment.halves.as_ref().is_some_and(|halves| halves.dependent.is_none())
    {
        bail!(
            "[halves]: blocks of seeds share their sessions; explain in `dependent` why the halves are not independent"
        );
    }
    if let Some(halves) = experiment.halves.as_ref().filter(|_| !by_seed) {
        halves.check(found.iter().map(|item| (item.name.as_str(), item.cluster.as_str())))?;
        for item in &mut found {
            item.half = Some(halves.of(&item.name)?);
        }
    }
    if let Some(half) = source.half {
        if experiment.halves.is_none() {
            bail!("has no [halves], but --half {} needs them; declare them", half.name());
        }
        found.retain(|item| by_seed || item.half == Some(half));
    }
    Ok(found)
}

/// The graphs that are files below the folder of data.
fn given_graphs(experiment: &Experiment, source: &Source) -> anyhow::Result<Vec<Item>> {
    let mut found = Vec::new();
    if experiment.graphs.is_empty() {
        return Ok(found);
    }
    let Some(data) = &source.data else {
        bail!("its graphs are files below a folder of data; name the folder with --data DIRECTORY");
    };
    for graphs in &experiment.graphs {
        found.extend(graphs.find(data)?.into_iter().map(|graph| Item {
            name: graph.name.clone(),
            cluster: graph.cluster.clone(),
            half: None,
            kind: Kind::Graph(graph),
        }));
    }
    Ok(found)
}

/// Adds the sessions, and the graphs of several sessions, that the experiment and its grids name.
fn add_sessions(
    experiment: &Experiment,
    source: &Source,
    found: &mut Vec<Item>,
    missing: &mut BTreeSet<String>,
) -> anyhow::Result<()> {
    let listed = experiment.grids.iter().filter_map(|grid| grid.sessions.as_ref()).flatten();
    let mut sessions: Vec<&String> = experiment.sessions.iter().chain(listed).collect();
    let mut seen = BTreeSet::new();
    sessions.retain(|name| seen.insert(name.as_str()));
    for name in sessions {
        if found.iter().any(|item| matches(std::slice::from_ref(name), &item.name).unwrap_or(false)) {
            // The name is that of a given graph, which a grid or the command line selects.
            continue;
        }
        if found.iter().any(Item::is_graph) && experiment.source.is_none() {
            bail!("there is no graph \"{name}\"; the experiment has {}", names(found));
        }
        let parts: Vec<&str> = name.split('+').collect();
        parts.iter().try_for_each(|part| check("session", part))?;
        if let Some(part) =
            parts.iter().find(|part| source.simulates(experiment) && !experiment.may_simulate(part))
        {
            bail!(
                "session \"{part}\" has no data, because no folder of sessions is named; name it with --nclt DIRECTORY, or list the \
                 session under simulated_sessions in the declaration to have it simulated"
            );
        }
        let data: Option<Vec<(String, String)>> =
            parts.iter().map(|part| Some(((*part).to_owned(), source.session(experiment, part)?))).collect();
        let Some(data) = data else {
            let absent = parts.iter().filter(|part| source.session(experiment, part).is_none());
            missing.extend(absent.map(|part| (*part).to_owned()));
            continue;
        };
        found.push(Item {
            name: name.clone(),
            cluster: name.clone(),
            half: None,
            kind: Kind::Sessions(data),
        });
    }
    Ok(())
}

/// The names of the sessions and graphs of an experiment with halves, each with its half. If halves are blocks of seeds, a name
/// occurs once for every seed.
pub fn members(experiment: &Experiment, source: &Source) -> anyhow::Result<Vec<(String, &'static str)>> {
    let by_seed = experiment.halves.as_ref().is_some_and(Halves::by_seed);
    let mut members = Vec::new();
    for item in items(experiment, source, &mut BTreeSet::new())? {
        for seed in 1..=if by_seed { experiment.seeds } else { 1 } {
            if let Some(half) = item.half_with(experiment, seed)? {
                members.push((item.name.clone(), half.name()));
            }
        }
    }
    Ok(members)
}

/// Whether an item belongs to a list of names and patterns.
pub(crate) fn matches(names: &[String], item: &str) -> anyhow::Result<bool> {
    Ok(names.iter().any(|name| name == item) || any(names, item).context("a list of sessions")?)
}

fn names(items: &[Item]) -> String {
    items.iter().map(|item| item.name.as_str()).collect::<Vec<_>>().join(", ")
}

//! An experiment as its TOML file declares it.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use serde::Deserialize;
use toml::Value;

use crate::names::{check, check_value};
use crate::{Drawn, Graphs, Halves, toml_text};

mod parts;

pub(crate) use parts::words;
pub use parts::{Grid, Step};
use parts::{grid, scalar, step};

/// The longest chain of declarations that build on each other.
const LONGEST_CHAIN: usize = 16;

/// The largest file that is read as a declaration: 16 MiB.
const LARGEST_FILE: u64 = 16 << 20;

/// A declared experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// The name of the experiment: the folder of its results and their label `pipeline`.
    pub name: String,
    /// The label `family` of its results, for tables over several experiments.
    pub family: Option<String>,
    /// Names of sessions. `A+B` joins the complete sessions A and B.
    pub sessions: Vec<String>,
    /// The origin of the sessions, if the declaration fixes it; otherwise the command line decides.
    pub source: Option<Origin>,
    /// Given graphs.
    pub graphs: Vec<Graphs>,
    /// Graphs that a program draws, one for each seed.
    pub drawn: Vec<Drawn>,
    /// Whether to run only those graphs that are listed under `sessions`, as the command line requests.
    pub only: bool,
    /// Which sessions and graphs are for tuning and which for tests.
    pub halves: Option<Halves>,
    /// The limit on CPU seconds of one task of a method. With a limit, a method that fails counts as a result.
    pub cpu_limit: Option<u64>,
    /// Names of sessions that may be simulated if no folder of real sessions is named. No other name is ever simulated, because it
    /// may be that of a user's own data.
    pub simulated_sessions: Option<Vec<String>>,
    /// Seeds 1 to this number.
    pub seeds: u64,
    /// Methods to run, in the order of tables.
    pub methods: Vec<String>,
    /// The method whose optimised graph the others are compared with.
    pub reference: String,
    /// The files to keep.
    pub keep: Keep,
    /// Steps by name.
    pub stages: BTreeMap<String, Step>,
    /// Methods as chains of steps between construction and optimisation.
    pub chains: BTreeMap<String, Vec<String>>,
    /// Parameters that options may name, with their default values, which grids override.
    pub parameters: BTreeMap<String, String>,
    /// Parameters that are computed from other parameters.
    pub derived: BTreeMap<String, Derived>,
    /// Blocks of parameter values. Without a block, the experiment has one point.
    pub grids: Vec<Grid>,
}

/// Where sessions come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// posecut-simulate makes them.
    Simulated,
    /// Sessions are real: from `--nclt`, or from the folder `nclt` below `--data`.
    Nclt,
}

/// The files of an experiment that stay after their last use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Keep {
    /// All files.
    #[default]
    All,
    /// Results and session graphs. Files between them are removed after their last use.
    Results,
}

/// A parameter computed from another one: `factor * of^power` in six significant digits, or a text selected by its value.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Derived {
    /// The other parameter. Without `texts` its value must be a number.
    pub of: String,
    /// The factor.
    #[serde(default = "one")]
    pub factor: f64,
    /// The exponent.
    #[serde(default = "one")]
    pub power: f64,
    /// A text for each value of the parameter, such as options that only some values need.
    #[serde(default)]
    pub texts: BTreeMap<String, String>,
    /// The text for all other values. Without it, other values are errors.
    pub otherwise: Option<String>,
}

fn one() -> f64 {
    1.0
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    base: Option<String>,
    name: Option<String>,
    #[expect(dead_code, reason = "for readers of the file")]
    about: Option<String>,
    family: Option<String>,
    sessions: Option<Vec<String>>,
    simulated_sessions: Option<Vec<String>>,
    source: Option<Origin>,
    #[serde(default)]
    graphs: Vec<Graphs>,
    #[serde(default)]
    drawn: Vec<Drawn>,
    halves: Option<Halves>,
    cpu_limit: Option<u64>,
    seeds: Option<u64>,
    methods: Option<Vec<String>>,
    reference: Option<String>,
    keep: Option<Keep>,
    #[serde(default)]
    stages: BTreeMap<String, Value>,
    #[serde(default)]
    method: BTreeMap<String, Vec<String>>,
    #[serde(default)]
    parameters: BTreeMap<String, Value>,
    #[serde(default)]
    derived: BTreeMap<String, Derived>,
    #[serde(default)]
    grid: Vec<BTreeMap<String, Value>>,
}

impl Experiment {
    /// Reads a declaration. Missing keys come from the file that it names as `base`, relative to its own folder.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        Self::read_above(path, &mut Vec::new())
    }

    /// Reads a declaration and its bases. `above` has the resolved paths of the declarations that build on it, to detect circles.
    fn read_above(path: &Path, above: &mut Vec<PathBuf>) -> anyhow::Result<Self> {
        let place = path.display();
        let text = text(path).with_context(|| format!("{place}: cannot be read"))?;
        let file: File = toml_text::parse(&text)
            .with_context(|| format!("{place}: is not a declaration of an experiment"))?;
        above.push(std::fs::canonicalize(path).with_context(|| format!("{place}: cannot be read"))?);
        let mut experiment = match &file.base {
            Some(base) => {
                let path = path.with_file_name(base);
                let real = std::fs::canonicalize(&path).ok();
                if real.is_some() && real.as_ref() == above.last() {
                    bail!("{place}: names itself as its base; name another file, or remove `base`");
                }
                if real.is_some_and(|real| above.contains(&real)) {
                    bail!(
                        "{place}: its base \"{base}\" builds on it in turn; remove `base` from one of them"
                    );
                }
                if above.len() == LONGEST_CHAIN {
                    bail!(
                        "{place}: is base {} of a chain, but a chain may have at most {LONGEST_CHAIN} declarations; merge some of them",
                        LONGEST_CHAIN - 1
                    );
                }
                Self::read_above(&path, above)
                    .with_context(|| format!("{place}: its base \"{base}\" cannot be used"))?
            }
            None => Self::empty(),
        };
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        experiment.overlay(file, stem).with_context(|| format!("{place}: cannot be used"))?;
        experiment.validate().with_context(|| format!("{place}: cannot be used"))?;
        Ok(experiment)
    }

    fn empty() -> Self {
        Self {
            name: String::new(),
            family: None,
            sessions: Vec::new(),
            source: None,
            graphs: Vec::new(),
            drawn: Vec::new(),
            only: false,
            halves: None,
            cpu_limit: None,
            simulated_sessions: None,
            seeds: 1,
            methods: Vec::new(),
            reference: "oracle".to_owned(),
            keep: Keep::All,
            stages: BTreeMap::new(),
            chains: BTreeMap::new(),
            parameters: BTreeMap::new(),
            derived: BTreeMap::new(),
            grids: Vec::new(),
        }
    }

    fn overlay(&mut self, file: File, stem: String) -> anyhow::Result<()> {
        self.name = file.name.unwrap_or(stem);
        // A declaration that names `sessions` of its own does not inherit `simulated_sessions`: those are other sessions.
        let inherited = self.simulated_sessions.take().filter(|_| file.sessions.is_none());
        self.simulated_sessions = file.simulated_sessions.or(inherited);
        self.sessions = file.sessions.unwrap_or(std::mem::take(&mut self.sessions));
        self.family = file.family.or(self.family.take());
        self.source = file.source.or(self.source);
        self.halves = file.halves.or(self.halves.take());
        self.cpu_limit = file.cpu_limit.or(self.cpu_limit);
        if !file.graphs.is_empty() {
            self.graphs = file.graphs;
        }
        if !file.drawn.is_empty() {
            self.drawn = file.drawn;
        }
        self.seeds = file.seeds.unwrap_or(self.seeds);
        self.methods = file.methods.unwrap_or(std::mem::take(&mut self.methods));
        self.reference = file.reference.unwrap_or(std::mem::take(&mut self.reference));
        self.keep = file.keep.unwrap_or(self.keep);
        for (name, value) in file.stages {
            let step = step(&value).with_context(|| format!("stages.{name}"))?;
            self.stages.insert(name, step);
        }
        self.chains.extend(file.method);
        for (name, value) in file.parameters {
            let value = scalar(&value).with_context(|| format!("parameters.{name}"))?;
            self.parameters.insert(name, value);
        }
        self.derived.extend(file.derived);
        if !file.grid.is_empty() {
            self.grids = file.grid.iter().map(grid).collect::<anyhow::Result<_>>()?;
        }
        Ok(())
    }

    /// Whether the declaration allows to simulate a session of this name.
    pub(crate) fn may_simulate(&self, session: &str) -> bool {
        let mut listed = self.simulated_sessions.iter().flatten().flat_map(|name| name.split('+'));
        self.source == Some(Origin::Simulated) || listed.any(|name| name == session)
    }

    /// Refuses contradictions, and names that would lead outside the folder of results.
    pub(crate) fn validate(&self) -> anyhow::Result<()> {
        self.check_names()?;
        let every = self.grids.iter().filter_map(|grid| grid.methods.as_ref()).flatten();
        for method in self.methods.iter().chain(every).chain([&self.reference]) {
            self.chain(method)?;
        }
        if let Some(halves) = &self.halves {
            halves.validate()?;
        }
        if self.cpu_limit == Some(0) {
            bail!("cpu_limit is 0, but must be at least 1 CPU second");
        }
        for grid in &self.grids {
            if let Some(axis) = grid.axes.keys().find(|axis| !self.parameters.contains_key(*axis)) {
                bail!("a grid varies \"{axis}\", which is not a parameter; declare it under [parameters]");
            }
        }
        if let Some((name, derived)) =
            self.derived.iter().find(|(_, derived)| !self.parameters.contains_key(&derived.of))
        {
            bail!("derived.{name} is computed from \"{}\", which is not a parameter; declare it", derived.of);
        }
        for name in self.parameters.keys().chain(self.derived.keys()) {
            if LABELS.contains(&name.as_str()) {
                bail!("\"{name}\" cannot be a parameter: results have a label of that name; rename it");
            }
        }
        Ok(())
    }

    /// Checks names, except those of sessions and graphs: their lists may hold patterns, so they are checked when they are found.
    fn check_names(&self) -> anyhow::Result<()> {
        check("the experiment's name", &self.name)?;
        for (method, steps) in &self.chains {
            check("method", method)?;
            steps.iter().try_for_each(|step| check("step", step))?;
        }
        for (name, value) in &self.parameters {
            check("parameter", name)?;
            check_value(&format!("parameters.{name}: the value"), value)?;
        }
        for (name, values) in self.grids.iter().flat_map(|grid| &grid.axes) {
            check("parameter", name)?;
            values.iter().try_for_each(|value| check_value(&format!("grid, {name}: the value"), value))?;
        }
        Ok(())
    }

    /// The steps of a method between construction and optimisation.
    pub fn chain(&self, method: &str) -> anyhow::Result<&[String]> {
        self.chains.get(method).map(Vec::as_slice).with_context(|| {
            let known: Vec<&str> = self.chains.keys().map(String::as_str).collect();
            format!("there is no method \"{method}\"; [method] declares {}", known.join(", "))
        })
    }

    /// Removes the declared options of a step of a method, because the program that replaces it does not know them.
    pub fn forget_options(&mut self, step: &str) {
        if self.chains.values().flatten().any(|other| other == step)
            && let Some(declared) = self.stages.get_mut(step)
        {
            declared.options.clear();
        }
    }

    /// Replaces the options of a step, as the command line requests.
    pub fn set_options(&mut self, step: &str, options: &str) {
        self.stages.entry(step.to_owned()).or_default().options = words(options);
    }
}

/// Labels of results that are not parameters.
const LABELS: &[&str] = &["pipeline", "family", "half", "cluster", "session", "seed", "method", "replaced"];

fn text(path: &Path) -> anyhow::Result<String> {
    let mut text = String::new();
    let read = std::fs::File::open(path)?.take(LARGEST_FILE + 1).read_to_string(&mut text)?;
    if read as u64 > LARGEST_FILE {
        bail!("it is larger than {} MiB, so it is not a declaration", LARGEST_FILE >> 20);
    }
    Ok(text)
}

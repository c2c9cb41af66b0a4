//! The arguments that all commands share: experiments, inputs and results.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use posecut_stage::warn;

use crate::{Experiment, Half, Plan, Programs, Source, plan};

/// Experiments and what the command line changes of them.
#[derive(Clone, Debug, clap::Args)]
pub struct Selection {
    /// Declarations of experiments (TOML), or one task list (JSON Lines)
    #[arg(required = true, value_name = "EXPERIMENT")]
    pub experiments: Vec<PathBuf>,

    /// Read the list of stage programs from this file
    #[arg(long, value_name = "FILE", default_value = "pipelines/stages.toml")]
    pub stages: PathBuf,

    /// Look for stage programs named without a path in this folder [default: the folder of this program]
    #[arg(long, value_name = "DIRECTORY")]
    pub programs: Option<PathBuf>,

    /// Use another program for a stage, called in the same way; may be repeated
    #[arg(long = "program", value_name = "STAGE=PROGRAM")]
    pub replacements: Vec<String>,

    /// Read NCLT sessions from this folder, as DATE/ or DATE_sen.tar.gz [default: simulate the sessions that the declaration lists under `simulated_sessions`]
    #[arg(long, value_name = "DIRECTORY")]
    pub nclt: Option<PathBuf>,

    /// Read given graphs from this folder, and real sessions from its subfolder nclt
    #[arg(long, value_name = "DIRECTORY")]
    pub data: Option<PathBuf>,

    /// Run only the sessions, graphs or seeds of this half
    #[arg(long, value_enum)]
    pub half: Option<Half>,

    /// Write simulated sessions to this folder
    #[arg(long, value_name = "DIRECTORY", default_value = "data/simulated")]
    pub simulated: PathBuf,

    /// Write results to this folder, or read them from it
    #[arg(long, value_name = "DIRECTORY", default_value = "results")]
    pub results: PathBuf,

    /// Use these sessions and graphs instead of the declared ones
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub sessions: Vec<String>,

    /// Use seeds 1 to N instead of the declared number
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub seeds: Option<u64>,

    /// Use these methods instead of the declared ones
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub methods: Vec<String>,

    /// Replace the options of a step of an experiment; may be repeated.
    ///
    /// For example `--set "paper.pcm=--probability 0.95"`.
    #[arg(long = "set", value_name = "EXPERIMENT.STEP=OPTIONS")]
    pub settings: Vec<String>,
}

impl Selection {
    /// The declarations, with the changes that the command line requests.
    pub fn declared(&self) -> anyhow::Result<Vec<Experiment>> {
        let mut experiments: Vec<Experiment> =
            self.experiments.iter().map(|path| Experiment::read(path)).collect::<anyhow::Result<_>>()?;
        for experiment in &mut experiments {
            if !self.sessions.is_empty() {
                experiment.sessions.clone_from(&self.sessions);
                experiment.only = true;
            } else if let (None, Some(simulated)) = (&self.nclt, &experiment.simulated_sessions) {
                experiment.sessions.clone_from(simulated);
            }
            experiment.seeds = self.seeds.unwrap_or(experiment.seeds);
            if !self.methods.is_empty() {
                experiment.methods.clone_from(&self.methods);
            }
            for grid in &mut experiment.grids {
                grid.sessions = grid.sessions.take().filter(|_| self.sessions.is_empty());
                grid.seeds = grid.seeds.filter(|_| self.seeds.is_none());
                grid.methods = grid.methods.take().filter(|_| self.methods.is_empty());
            }
            experiment.validate().with_context(|| format!("experiment {}", experiment.name))?;
        }
        for (stage, program) in self.replacements()? {
            // The declared options belong to this workspace's program. A replacement gets only options from the command line.
            let ours = self.programs.as_deref().is_some_and(|folder| Path::new(program).starts_with(folder));
            for experiment in experiments.iter_mut().filter(|_| !ours) {
                experiment.forget_options(stage);
            }
        }
        for setting in &self.settings {
            let parts = setting.split_once('=').and_then(|(place, options)| {
                let (experiment, step) = place.rsplit_once('.')?;
                Some((experiment, step, options))
            });
            let Some((name, step, options)) = parts else {
                bail!(
                    "--set {setting}: expected EXPERIMENT.STEP=OPTIONS, such as paper.pcm='--probability 0.95'"
                );
            };
            for experiment in experiments.iter_mut().filter(|experiment| experiment.name == name) {
                experiment.set_options(step, options);
            }
        }
        Ok(experiments)
    }

    /// The stage programs, with the replacements from the command line.
    pub fn programs(&self) -> anyhow::Result<Programs> {
        let beside = std::env::current_exe().ok().and_then(|path| Some(path.parent()?.to_owned()));
        let mut programs = Programs::read(&self.stages, self.programs.as_deref().or(beside.as_deref()))?;
        for (stage, program) in self.replacements()? {
            programs.replace(stage, program)?;
        }
        Ok(programs)
    }

    /// Pairs of a stage and the program that replaces the stage's own.
    fn replacements(&self) -> anyhow::Result<Vec<(&str, &str)>> {
        let parted =
            |text: &'_ str| format!("--program {text}: expected STAGE=PROGRAM, such as pcm=./my-stage");
        self.replacements.iter().map(|text| text.split_once('=').with_context(|| parted(text))).collect()
    }

    /// The plan, read from a task list if one is named, otherwise expanded from the declarations.
    pub fn plan(&self) -> anyhow::Result<Plan> {
        let is_list = |path: &Path| path.extension().is_some_and(|extension| extension == "jsonl");
        if let [list] = self.experiments.as_slice()
            && is_list(list)
        {
            return Plan::read(list, &self.source());
        }
        let source = self.source();
        let (plan, missing) = plan(&self.declared()?, &self.programs()?, &source)?;
        if !missing.is_empty() {
            let nclt = self.nclt.clone().or(self.data.as_ref().map(|data| data.join("nclt")));
            let folder = nclt.unwrap_or_else(|| PathBuf::from("data/nclt"));
            warn!("no data in {} for: {}", folder.display(), missing.join(", "));
        }
        if plan.tasks.is_empty() {
            bail!("there is nothing to run: no session has data, or there is no graph, seed or method");
        }
        Ok(plan)
    }

    /// The folders of inputs and results.
    fn source(&self) -> Source {
        Source {
            nclt: self.nclt.clone(),
            data: self.data.clone(),
            half: self.half,
            simulated: self.simulated.clone(),
            results: self.results.clone(),
        }
    }
}

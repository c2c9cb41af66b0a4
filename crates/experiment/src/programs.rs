//! The stage programs that `pipelines/stages.toml` lists.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail};
use posecut_stage::Phase;
use posecut_stage::registry::Registry;
use serde::Deserialize;

/// Stage programs by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Programs {
    listed: BTreeMap<String, Program>,
    /// Programs from elsewhere that the command line put in the place of a stage's own.
    replaced: BTreeMap<String, String>,
    /// Programs that the list leaves out.
    registry: Registry,
    /// The folder that is searched before the PATH for programs named without a path.
    folder: Option<PathBuf>,
}

/// How to call one stage program.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// A name to search on the PATH, or a path.
    pub path: String,
    /// The command line: `{program}`, `{options}`, `{input}`, `{output}`, and further names that the stage needs.
    pub argv: Vec<String>,
    /// The words to append if statistics are wanted. `{statistics}` is the file.
    pub statistics: Vec<String>,
    /// The command that prints the version, which shows that the program is there.
    pub version: Vec<String>,
    /// Files other than the program that decide what it does, such as a script.
    pub files: Vec<String>,
}

/// A section of the list. Missing keys get the values that fit every stage of this workspace.
#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Section {
    program: Option<String>,
    argv: Option<Vec<String>>,
    statistics: Option<Vec<String>>,
    version: Option<Vec<String>>,
    #[serde(default)]
    files: Vec<String>,
}

impl Section {
    fn program(self, stage: &str) -> Program {
        let words = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect();
        // A section with a command line or program of its own must also say how to get statistics or the version.
        let statistics = if self.argv.is_some() { &[][..] } else { &["--stats", "{statistics}"] };
        let version = if self.program.is_some() { &[][..] } else { &["{program}", "--version"] };
        Program {
            statistics: self.statistics.unwrap_or_else(|| words(statistics)),
            version: self.version.unwrap_or_else(|| words(version)),
            path: self.program.unwrap_or_else(|| format!("posecut-{stage}")),
            argv: self.argv.unwrap_or_else(|| {
                words(&["{program}", "--quiet", "{input}", "{options}", "-o", "{output}"])
            }),
            files: self.files,
        }
    }
}

impl Programs {
    /// Reads the list. Programs named without a path are searched in `folder` first.
    pub fn read(path: &Path, folder: Option<&Path>) -> anyhow::Result<Self> {
        let place = path.display();
        let text = std::fs::read_to_string(path).with_context(|| format!("{place}: cannot be read"))?;
        let sections: BTreeMap<String, Section> = crate::toml_text::parse(&text)
            .with_context(|| format!("{place}: is not a list of stage programs"))?;
        let path = std::env::var_os("PATH").unwrap_or_default();
        let registry = Registry::of(folder, std::env::split_paths(&path));
        let mut programs = Self { registry, folder: folder.map(Path::to_owned), ..Self::default() };
        for (stage, section) in sections {
            let program = programs.found(section.program(&stage));
            programs.listed.insert(stage, program);
        }
        Ok(programs)
    }

    /// Replaces the program of a stage. The new program is called with the same command line.
    pub fn replace(&mut self, stage: &str, program: &str) -> anyhow::Result<()> {
        let known = self.get(stage).with_context(|| format!("--program {stage}={program}"))?.into_owned();
        self.listed.insert(stage.to_owned(), Program { path: program.to_owned(), ..known });
        if !self.folder.as_deref().is_some_and(|folder| Path::new(program).starts_with(folder)) {
            self.replaced.insert(stage.to_owned(), program.to_owned());
        }
        Ok(())
    }

    /// Which of these stages are replaced, and by which programs, for tables: `pcm = ./my-stage`. `None` if none is.
    pub(crate) fn replaced<'a>(&self, stages: impl Iterator<Item = &'a str>) -> Option<String> {
        let stages: BTreeSet<&str> = stages.collect();
        let named = self.replaced.iter().filter(|(stage, _)| stages.contains(stage.as_str()));
        let listed: Vec<String> = named.map(|(stage, program)| format!("{stage} = {program}")).collect();
        (!listed.is_empty()).then(|| listed.join(", "))
    }

    /// The program of a stage. If the list leaves the stage out, this is the program `posecut-STAGE`, if it exists; it is called
    /// like every stage from graph to graph.
    pub fn get(&self, stage: &str) -> anyhow::Result<Cow<'_, Program>> {
        if let Some(program) = self.listed.get(stage) {
            return Ok(Cow::Borrowed(program));
        }
        let Some(found) = self.registry.get(stage) else {
            let known: Vec<&str> = self.listed.keys().map(String::as_str).collect();
            bail!(
                "there is no stage \"{stage}\": the list of stages has {}, and there is no program posecut-{stage}; correct \
                 the name, or build the program",
                known.join(", ")
            );
        };
        Ok(Cow::Owned(usual(&found)))
    }

    /// The same program with its path, if it is in the folder of programs.
    fn found(&self, program: Program) -> Program {
        match self.folder.as_deref().and_then(|folder| beside(folder, &program.path)) {
            Some(path) => Program { path, ..program },
            None => program,
        }
    }

    /// Every stage with its program and the output of its version command: the stages of the list, and those in the folder of
    /// programs.
    pub fn versions(&self) -> Vec<(String, String, anyhow::Result<String>)> {
        let mut stages = self.listed.clone();
        for found in self.registry.beside() {
            if !stages.contains_key(&found.name)
                && found.description().is_some_and(|description| description.phase != Phase::Runs)
            {
                stages.insert(found.name.clone(), usual(&found));
            }
        }
        stages
            .into_iter()
            .map(|(name, program)| {
                let version = program.version();
                (name, program.path, version)
            })
            .collect()
    }
}

/// A program that is called like every stage from graph to graph.
fn usual(found: &posecut_stage::registry::Program) -> Program {
    let path = found.path.to_string_lossy().into_owned();
    Program { path, ..Section::default().program(&found.name) }
}

impl Program {
    fn version(&self) -> anyhow::Result<String> {
        let Some((_, arguments)) = self.version.split_first() else { bail!("has no version command") };
        let output = Command::new(&self.path)
            .args(arguments)
            .output()
            .with_context(|| format!("{}: cannot be started", self.path))?;
        if !output.status.success() {
            bail!("{}: its version command ended with {}", self.path, output.status);
        }
        Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    }
}

fn beside(folder: &Path, program: &str) -> Option<String> {
    let path = folder.join(format!("{program}{}", std::env::consts::EXE_SUFFIX));
    (!program.contains('/') && path.is_file()).then(|| path.to_string_lossy().into_owned())
}

/// The file of a program: the given path, or else the first program of this name on the PATH.
pub(crate) fn locate(program: &str) -> anyhow::Result<PathBuf> {
    if program.contains('/') {
        let path = PathBuf::from(program);
        return if path.is_file() {
            Ok(path)
        } else {
            bail!("{program}: this program does not exist; build it, or name another one")
        };
    }
    std::env::var_os("PATH")
        .and_then(|path| {
            std::env::split_paths(&path).map(|folder| folder.join(program)).find(|path| path.is_file())
        })
        .with_context(|| format!("{program}: is not on the PATH; build it, or name its path with --program"))
}

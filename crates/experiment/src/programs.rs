//! The stage programs, as `pipelines/stages.toml` lists them.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail};
use serde::Deserialize;

/// Stage programs by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Programs {
    programs: BTreeMap<String, Program>,
}

/// How one stage program is called.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Program {
    /// A name, looked for in the folder of programs and then on the PATH, or a path.
    #[serde(rename = "program")]
    pub path: String,
    /// The command line: `{program}`, `{options}`, `{input}`, `{output}`, and what the stage needs besides.
    pub argv: Vec<String>,
    /// Appended where statistics are wanted: `{statistics}` is the file.
    #[serde(default)]
    pub statistics: Vec<String>,
    /// Prints the version: a receipt that the program is there.
    #[serde(default)]
    pub version: Vec<String>,
    /// Files besides the program that decide what it does, such as a script.
    #[serde(default)]
    pub files: Vec<String>,
}

impl Programs {
    /// Reads the list; `folder` is where programs named without a path are looked for first.
    pub fn read(path: &Path, folder: Option<&Path>) -> anyhow::Result<Self> {
        let place = path.display();
        let text = std::fs::read_to_string(path).with_context(|| format!("{place}: cannot be read"))?;
        let mut programs: BTreeMap<String, Program> = crate::toml_text::parse(&text)
            .with_context(|| format!("{place}: is no list of stage programs"))?;
        for program in programs.values_mut() {
            if let Some(found) = folder.and_then(|folder| beside(folder, &program.path)) {
                program.path = found;
            }
        }
        Ok(Self { programs })
    }

    /// Puts another program in a stage's place; it is called by the same command line.
    pub fn replace(&mut self, stage: &str, program: &str) -> anyhow::Result<()> {
        self.programs.get_mut(stage).map(|known| program.clone_into(&mut known.path)).with_context(|| {
            format!("--program {stage}={program}: there is no stage \"{stage}\" in the list of stages")
        })
    }

    /// A program by its stage's name.
    pub fn get(&self, stage: &str) -> anyhow::Result<&Program> {
        self.programs.get(stage).with_context(|| {
            let known: Vec<&str> = self.programs.keys().map(String::as_str).collect();
            format!("there is no stage \"{stage}\" in the list of stages, which has {}", known.join(", "))
        })
    }

    /// Every stage with its program and what the version command says.
    pub fn versions(&self) -> Vec<(String, String, anyhow::Result<String>)> {
        self.programs
            .iter()
            .map(|(name, program)| (name.clone(), program.path.clone(), program.version()))
            .collect()
    }
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

/// The file of a program: itself if it has a path, else the first of its name on the PATH.
pub(crate) fn locate(program: &str) -> anyhow::Result<PathBuf> {
    if program.contains('/') {
        let path = PathBuf::from(program);
        return if path.is_file() {
            Ok(path)
        } else {
            bail!("{program}: there is no such program; build it, or name another")
        };
    }
    std::env::var_os("PATH")
        .and_then(|path| {
            std::env::split_paths(&path).map(|folder| folder.join(program)).find(|path| path.is_file())
        })
        .with_context(|| format!("{program}: is not on the PATH; build it, or name its path with --program"))
}

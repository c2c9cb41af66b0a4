//! Runs processes on one or two processors, and prepares their inputs.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use anyhow::bail;
use xtask::workspace::{program, shared_data, target};

use crate::process::{Ended, Measured, measure};

/// The folder for graphs and estimates.
pub(super) fn work() -> PathBuf {
    target().join("comparison")
}

/// A number from the environment, or the default.
pub(super) fn given(name: &str, default: f64) -> anyhow::Result<f64> {
    match std::env::var(name) {
        Err(_) => Ok(default),
        Ok(text) => match text.parse() {
            Ok(number) => Ok(number),
            Err(_) => bail!("{name}={text}: is not a number"),
        },
    }
}

/// A command that runs on as many processors as it has threads.
pub(super) struct Pinned {
    command: Command,
}

impl Pinned {
    pub(super) fn new(program: &Path, threads: usize) -> Self {
        let mut command = Command::new("taskset");
        command.args(["-c", &format!("0-{}", threads - 1)]).arg(program);
        command.env("RAYON_NUM_THREADS", threads.to_string()).env("OPENBLAS_NUM_THREADS", "1");
        Self { command }
    }

    /// A program of posecut on one processor, without messages.
    pub(super) fn posecut(name: &str) -> Self {
        Self::new(&program(name), 1).words(&["-q"])
    }

    pub(super) fn words(mut self, words: &[&str]) -> Self {
        self.command.args(words);
        self
    }

    pub(super) fn path(mut self, path: impl AsRef<OsStr>) -> Self {
        self.command.arg(path);
        self
    }

    /// Runs the command and returns the measurement, or the reason for failure in a few words.
    pub(super) fn run(mut self) -> anyhow::Result<Result<Measured, String>> {
        let limit = given("LIMIT", 40.0)?;
        Ok(match measure(&mut self.command, Duration::try_from_secs_f64(limit)?)? {
            Ended::Done(measured) => Ok(measured),
            Ended::OutOfTime => Err(format!("over {limit:.0} s")),
            Ended::Failed(said) => Err(said.lines().last().unwrap_or("no word").chars().take(200).collect()),
        })
    }

    /// Runs the command and returns the measurement; any failure is an error.
    pub(super) fn must(self) -> anyhow::Result<Measured> {
        let called = crate::process::shown(&self.command);
        match self.run()? {
            Ok(measured) => Ok(measured),
            Err(why) => bail!("{called}: {why}"),
        }
    }
}

/// A benchmark graph as JSON Lines.
pub(super) fn converted(name: &str) -> anyhow::Result<PathBuf> {
    let source = shared_data()?.join(format!("g2o/{name}.g2o"));
    let graph = work().join(format!("{name}.jsonl"));
    Pinned::posecut("convert").path(source).words(&["-o"]).path(&graph).must()?;
    Ok(graph)
}

/// Writes the initial poses of a graph, without optimising.
pub(super) fn started(graph: &Path, initialisation: &str, output: &Path) -> anyhow::Result<()> {
    let optimize =
        Pinned::posecut("optimize").words(&["--initialisation", initialisation, "--max-iterations", "0"]);
    optimize.path(graph).words(&["-o"]).path(output).must()?;
    Ok(())
}

/// The number of nodes of a graph.
pub(super) fn nodes(graph: &Path) -> anyhow::Result<u64> {
    let mut nodes = 0;
    for line in BufReader::new(File::open(graph)?).lines() {
        nodes += u64::from(line?.replace(' ', "").contains("\"kind\":\"node\""));
    }
    Ok(nodes)
}

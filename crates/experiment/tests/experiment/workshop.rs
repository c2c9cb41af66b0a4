//! A folder with an experiment whose stages are one shell script. Each call logs that it ran; its output consists of its
//! arguments and its input.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

const STAGE: &str = r#"#!/bin/sh
# stage.sh NAME INPUTS… -- OPTIONS… -o OUTPUT
name=$1
shift
echo "$name" >> log
[ -e "fail-$name" ] && { echo "$name is out of order" >&2; exit 3; }
[ -e slow ] && sleep 0.02
inputs=
while [ "$1" != -- ]; do inputs="$inputs $1"; shift; done
shift
said=
while [ "$1" != -o ]; do said="$said $1"; shift; done
output=$2
{ echo "$name$said"; [ -z "$inputs" ] || cat $inputs; } > "$output.new"
mv "$output.new" "$output"
"#;

const STAGES: &str = r#"
[simulate]
program = "./stage.sh"
argv = ["{program}", "simulate", "--", "{options}", "-o", "{output}"]
[ingest]
program = "./stage.sh"
argv = ["{program}", "ingest", "{input}", "--", "{options}", "-o", "{output}"]
[construct]
program = "./stage.sh"
argv = ["{program}", "construct", "{input}", "--", "{options}", "{seed}", "-o", "{output}"]
[simulate-graph]
program = "./stage.sh"
argv = ["{program}", "simulate-graph", "--", "{options}", "{seed}", "-o", "{output}"]
[convert]
program = "./stage.sh"
argv = ["{program}", "convert", "{input}", "--", "{options}", "-o", "{output}"]
[label]
program = "./stage.sh"
argv = ["{program}", "label", "{input}", "--", "{options}", "-o", "{output}"]
[oracle]
program = "./stage.sh"
argv = ["{program}", "oracle", "{input}", "--", "{options}", "-o", "{output}"]
[pcm]
program = "./stage.sh"
argv = ["{program}", "pcm", "{input}", "--", "{options}", "-o", "{output}"]
[multicut]
program = "./stage.sh"
argv = ["{program}", "multicut", "{input}", "--", "{options}", "-o", "{output}"]
[optimize]
program = "./stage.sh"
argv = ["{program}", "optimize", "{input}", "--", "{options}", "-o", "{output}"]
[evaluate]
program = "./stage.sh"
argv = ["{program}", "evaluate", "{input}", "{reference}", "--", "{options}", "{labels}", "-o", "{output}"]
"#;

pub(crate) const EXPERIMENT: &str = r#"
sessions = ["one", "two"]
simulated_sessions = ["one", "two"]
seeds = 2
methods = ["pcm", "pcm+gc"]

[stages]
pcm = "--gate 1"

[method]
none = []
pcm = ["pcm"]
"pcm+gc" = ["pcm", "multicut"]
oracle = ["oracle"]
"#;

pub(crate) const GRID: &str = r#"
keep = "results"
sessions = ["one", "two"]
simulated_sessions = ["one", "two"]
seeds = 2
methods = ["none", "pcm+gc"]

[stages]
ingest = "--sigma {sigma}"
construct = "--rate {rate} --kind {kind}"
pcm = "--gate {gate}"

[method]
none = []
"pcm+gc" = ["pcm", "multicut"]
oracle = ["oracle"]

[parameters]
scale = 1
rate = 0.1
kind = "uniform"
gate = 0.99

[derived]
sigma = { of = "scale", factor = 0.1, power = 0.5 }

[[grid]]
scale = [1, 9]
rate = [0.1, 0.5]

[[grid]]
kind = ["grouped"]
gate = [0.9, 0.99]
methods = ["pcm+gc"]
sessions = ["one"]
seeds = 1
"#;

pub(crate) struct Workshop {
    folder: tempfile::TempDir,
}

impl Workshop {
    pub(crate) fn new(experiment: &str) -> Self {
        Self::within(&std::env::temp_dir(), experiment)
    }

    /// A workshop in a given folder.
    pub(crate) fn within(parent: &Path, experiment: &str) -> Self {
        let folder = tempfile::Builder::new().prefix("workshop").tempdir_in(parent).unwrap();
        let workshop = Self { folder };
        workshop.write("stages.toml", STAGES);
        workshop.write("trial.toml", experiment);
        workshop.program("stage.sh", STAGE);
        workshop
    }

    /// Writes a script that can be run. It is copied by another process: the system refuses to run a file that a child of another
    /// test still has open for writing.
    pub(crate) fn program(&self, name: &str, script: &str) {
        self.write("script", script);
        let mut install = Command::new("install");
        install.args(["-m", "755"]).args([self.path("script"), self.path(name)]);
        assert!(install.status().unwrap().success(), "{name}");
        self.remove("script");
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, text: &str) {
        fs::write(self.path(name), text).unwrap();
    }

    pub(crate) fn remove(&self, name: &str) {
        fs::remove_file(self.path(name)).unwrap();
    }

    /// The command that runs posecut-experiment in this folder on the experiment.
    pub(crate) fn command(&self, task: &str, more: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_posecut-experiment"));
        command.current_dir(self.folder.path()).arg(task);
        if !more.contains(&"plan.jsonl") {
            command.arg("trial.toml");
        }
        command.args(["--stages", "stages.toml", "--simulated", "simulated"]).args(more);
        command
    }

    pub(crate) fn call(&self, task: &str, more: &[&str]) -> Output {
        self.command(task, more).output().unwrap()
    }

    /// Runs the experiment; returns the statistics.
    pub(crate) fn run(&self, more: &[&str]) -> serde_json::Value {
        let output = self.call("run", &[more, &["--stats", "run.json", "--threads", "2"]].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&fs::read(self.path("run.json")).unwrap()).unwrap()
    }

    /// How often each stage has run since the log was last taken.
    pub(crate) fn take_log(&self) -> BTreeMap<String, usize> {
        let text = fs::read_to_string(self.path("log")).unwrap_or_default();
        let _ = fs::remove_file(self.path("log"));
        let mut counts = BTreeMap::new();
        for line in text.lines() {
            *counts.entry(line.to_owned()).or_default() += 1;
        }
        counts
    }

    /// All files below a folder, with their content.
    pub(crate) fn files(&self, folder: &str) -> BTreeMap<String, String> {
        let mut files = BTreeMap::new();
        gather(&self.path(folder), self.folder.path(), &mut files);
        // CPU seconds differ from run to run.
        files.retain(|name, _| !name.ends_with(".times.jsonl"));
        files
    }

    /// All files that a run leaves.
    pub(crate) fn left(&self) -> BTreeMap<String, String> {
        let mut files = self.files("results");
        files.extend(self.files("simulated"));
        // Ignore locks: they are empty, and which of them exist depends on how the plan was divided.
        files.retain(|name, _| {
            std::path::Path::new(name).extension().is_none_or(|extension| extension != "lock")
        });
        files
    }
}

fn gather(folder: &Path, root: &Path, files: &mut BTreeMap<String, String>) {
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            gather(&path, root, files);
        } else {
            let name = path.strip_prefix(root).unwrap().to_string_lossy().into_owned();
            files.insert(name, fs::read_to_string(&path).unwrap());
        }
    }
}

pub(crate) fn counts(pairs: &[(&str, usize)]) -> BTreeMap<String, usize> {
    pairs.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect()
}

/// Asserts that files are the same. A failure names the files that differ, without their content.
pub(crate) fn assert_same(left: &BTreeMap<String, String>, right: &BTreeMap<String, String>, what: &str) {
    let names: std::collections::BTreeSet<&String> = left.keys().chain(right.keys()).collect();
    let other: Vec<&&String> = names.iter().filter(|name| left.get(**name) != right.get(**name)).collect();
    assert!(other.is_empty(), "{what}: {other:?}");
}

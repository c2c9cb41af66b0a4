//! The cases: every way in which a program writes.

use std::path::Path;

use posecut_contract::{long_tests, program, run, samples};

use super::folder::copy;
use super::reports::reports;
use crate::table::streams;
use posecut_contract::registry::table;

/// Where standard output goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Out {
    Pipe,
    File,
}

/// A call of a program in a folder of its own.
pub(super) struct Case {
    pub(super) name: String,
    pub(super) program: &'static str,
    pub(super) arguments: Vec<String>,
    pub(super) out: Out,
    /// Fills the folder.
    pub(super) prepare: fn(&Path),
    /// The names that a message may use: the files on the command line.
    pub(super) names: Vec<String>,
    /// The largest number of calls to fail.
    pub(super) most: usize,
    /// JSON files that contain times.
    varying: Vec<&'static str>,
    /// Files to which lines are appended.
    growing: Vec<&'static str>,
    /// Folders that must appear completely or not at all.
    pub(super) wholes: Vec<&'static str>,
    /// Whether the same call, repeated without a fault, finishes the work.
    pub(super) resumes: bool,
}

impl Case {
    pub(super) fn new(program: &'static str, arguments: &[String], prepare: fn(&Path)) -> Self {
        Self {
            name: format!("posecut-{program} {}", arguments.join(" ")),
            program,
            arguments: arguments.to_vec(),
            out: Out::Pipe,
            prepare,
            names: vec!["standard output".to_owned()],
            // posecut-conform is slow, because it waits for the program that it checks.
            most: if program == "conform" { 8 } else { 40 },
            varying: vec!["stats.json", ".times.jsonl"],
            growing: Vec::new(),
            wholes: Vec::new(),
            resumes: false,
        }
    }

    pub(super) fn naming(self, names: &[&str]) -> Self {
        Self { names: names.iter().map(|&name| name.to_owned()).collect(), ..self }
    }

    pub(super) fn varies(&self, file: &Path) -> bool {
        self.varying.iter().any(|ending| file.to_string_lossy().ends_with(ending))
    }

    pub(super) fn grows(&self, file: &Path) -> bool {
        self.growing.iter().any(|ending| file.to_string_lossy().ends_with(ending))
    }
}

/// Fills a folder with outputs of an earlier run.
pub(super) fn old_outputs(folder: &Path) {
    for name in ["out", "stats.json", "further"] {
        std::fs::write(folder.join(name), "precious").unwrap();
    }
}

fn empty(_: &Path) {}

pub(super) fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|&word| word.to_owned()).collect()
}

pub(super) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for (number, row) in streams().enumerate() {
        // All programs write with the same code. In the short form each replaces old outputs, and a third of them write in each of the
        // other ways.
        let has_turn = |way: usize| long_tests() || number % 3 == way;
        let (file, stats) = (["-o", "out"], ["--stats", "stats.json"]);
        let both = row.arguments_with(&[file, stats].concat());
        // posecut-conform writes all files other than its report to the folder of temporary files.
        let conform: &[&str] =
            if row.name == "conform" { &["temporary", "input.jsonl", "output.jsonl"] } else { &[] };
        let names = |names: &[&'static str]| [names, conform].concat();
        cases.push(Case::new(row.name, &both, old_outputs).naming(&names(&["out", "stats.json"])));
        if row.name != "conform" && has_turn(0) {
            cases.push(Case::new(row.name, &both, empty).naming(&names(&["out", "stats.json"])));
        }
        let pipe = Case::new(row.name, &row.arguments(), empty).naming(&names(&["standard output"]));
        if row.name != "conform" && has_turn(1) {
            cases.push(Case { out: Out::File, ..Case::new(row.name, &row.arguments(), empty) });
        }
        if row.name == "conform" || has_turn(2) {
            cases.push(pipe);
        }
    }
    for row in table() {
        for answer in [&["--help"][..], &["--generate", "man"]] {
            cases.push(Case::new(row.name, &words(answer), empty));
        }
    }
    let graph = samples().path("graph.jsonl");
    let compressed: &[&str] = &[&graph, "-o", "further.gz"];
    cases.push(Case::new("multicut", &words(compressed), old_outputs).naming(&["further.gz"]));
    for (name, options) in [
        ("pcm", &["--consistency-graph"][..]),
        ("multicut", &["--certificate"]),
        ("isam", &["--every", "50", "--estimates"]),
    ] {
        let all = [&[graph.as_str()], options, &["further", "-o", "out", "--stats", "stats.json"]].concat();
        cases.push(Case::new(name, &words(&all), old_outputs).naming(&["further", "out", "stats.json"]));
    }
    let partition = ["solve", &samples().path("four.mc"), "--certificate", "further", "-o", "out"];
    cases.push(Case::new("partition", &words(&partition), old_outputs).naming(&["further", "out"]));
    cases.extend(simulations());
    cases.extend(experiments());
    cases.extend(reports());
    cases
}

fn simulations() -> Vec<Case> {
    let arguments = ["--length", "100", "--rate", "5", "-o", "2012-01-22", "--stats", "stats.json"];
    let old = |folder: &Path| {
        let output =
            run("simulate", &["--length", "60", "-o", folder.join("2012-01-22").to_str().unwrap()], b"");
        assert!(output.status.success());
    };
    let anew = Case::new("simulate", &words(&arguments), empty);
    let instead = Case::new("simulate", &words(&[&arguments[..], &["--overwrite"]].concat()), old);
    [anew, instead]
        .map(|case| Case { wholes: vec!["2012-01-22"], ..case }.naming(&["2012-01-22", "stats.json"]))
        .into()
}

/// A stage that copies its input.
const STAGE: &str = r#"#!/bin/sh
while [ "$1" != -o ]; do inputs="$inputs $1"; shift; done
{ echo "$2"; [ -z "$inputs" ] || cat $inputs; } > "$2.new" && mv "$2.new" "$2"
"#;

const EXPERIMENT: &str = r#"
sessions = ["one"]
simulated_sessions = ["one"]
seeds = 1
methods = ["pcm"]
[method]
oracle = ["oracle"]
pcm = ["pcm"]
"#;

fn experiment(folder: &Path) {
    // Copied by another process: the system refuses to run a file that a child of another test still has open for writing.
    std::fs::write(folder.join("stage.text"), STAGE).unwrap();
    let mut install = std::process::Command::new("install");
    install.args(["-m", "755"]).args([folder.join("stage.text"), folder.join("stage.sh")]);
    assert!(install.status().unwrap().success());
    std::fs::write(folder.join("trial.toml"), EXPERIMENT).unwrap();
    let inputs = |stage: &str| match stage {
        "simulate" => "",
        "evaluate" => "\"{input}\", \"{reference}\", ",
        _ => "\"{input}\", ",
    };
    let stages =
        ["simulate", "ingest", "construct", "label", "oracle", "pcm", "multicut", "optimize", "evaluate"];
    let text = stages.map(|stage| {
        let inputs = inputs(stage);
        format!(
            "[{stage}]\nprogram = \"./stage.sh\"\nargv = [\"{{program}}\", {inputs}\"-o\", \"{{output}}\"]\n"
        )
    });
    std::fs::write(folder.join("stages.toml"), text.concat()).unwrap();
}

/// An experiment that has run, with a last result that can be compared.
fn finished_experiment(folder: &Path) {
    experiment(folder);
    let arguments = experiment_arguments("run", &[]);
    let output = std::process::Command::new(program("experiment"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let result = folder.join("results/trial-simulated/one/1/pcm.result.json");
    std::fs::copy(samples().path("x.result.json"), result).unwrap();
    old_outputs(folder);
}

/// An experiment whose results are a session, graphs and a result, and expectations that record none of them.
fn unrecorded_experiment(folder: &Path) {
    finished_experiment(folder);
    let results = folder.join("results/trial-simulated/one");
    let graphs = ["graph", "oracle", "oracle.optimized", "pcm", "pcm.optimized"];
    for file in graphs.map(|name| results.join("1").join(format!("{name}.jsonl"))) {
        std::fs::copy(samples().path("graph.jsonl"), file).unwrap();
    }
    std::fs::copy(samples().path("session.jsonl"), results.join("session.jsonl")).unwrap();
    let session = folder.join("simulated/one");
    std::fs::remove_file(&session).unwrap();
    std::fs::create_dir(&session).unwrap();
    copy(Path::new(&samples().path("2012-01-22")), &session);
    let tolerances = ["information", "landmark", "odometry", "other", "pose", "rmse"].map(|quantity| {
        format!("[tolerance.{quantity}]\nabsolute = 0.001\nrelative = 0.001\nreason = \"rounding\"\n")
    });
    let cover = "[[cover]]\nexperiment = \"trial-simulated\"\nseeds = 1\nmean_over = 1\n";
    std::fs::write(folder.join("expected.toml"), tolerances.concat() + cover).unwrap();
}

fn experiment_arguments(task: &str, more: &[&str]) -> Vec<String> {
    let common = ["trial.toml", "--stages", "stages.toml", "--simulated", "simulated", "--threads", "1"];
    words(&[&[task], &common[..], more].concat())
}

fn experiments() -> Vec<Case> {
    let run = Case {
        resumes: true,
        growing: vec![".tasks.jsonl"],
        ..Case::new("experiment", &experiment_arguments("run", &["--stats", "stats.json"]), experiment)
    };
    let collect = ["--times", "further", "-o", "out"];
    let ends = ["--expected", "expected.toml", "-o", "out", "--stats", "stats.json"];
    let check = [&["--junit", "further"], &ends[..]].concat();
    vec![
        run.naming(&["results/", "simulated/", "stats.json"]),
        Case::new("experiment", &experiment_arguments("collect", &collect), finished_experiment)
            .naming(&["further", "out"]),
        Case::new("experiment", &experiment_arguments("check", &check), unrecorded_experiment).naming(&[
            "further",
            "out",
            "stats.json",
        ]),
        Case::new("experiment", &experiment_arguments("accept", &ends), unrecorded_experiment).naming(&[
            "expected.toml",
            "out",
            "stats.json",
        ]),
    ]
}

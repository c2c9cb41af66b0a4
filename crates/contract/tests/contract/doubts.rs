//! Tests that a doubtful result is reported on standard error, in `--stats`, in the provenance and by the exit status.

use std::collections::{BTreeMap, BTreeSet};

use posecut_contract::registry::programs;
use posecut_contract::{run, workspace};
use serde_json::Value;
use xtask::documentation::generated;

use crate::doubtful_inputs::path;
use crate::table::streams;

/// A command that raises a doubt.
struct Case {
    program: &'static str,
    doubt: &'static str,
    /// Names in braces are files of `doubtful_inputs.rs`, or samples.
    arguments: &'static [&'static str],
}

const fn case(program: &'static str, doubt: &'static str, arguments: &'static [&'static str]) -> Case {
    Case { program, doubt, arguments }
}

/// Every doubt of every program.
const CASES: &[Case] = &[
    case("clean", "calibration-on-prior", &["{right.jsonl}"]),
    case("clean", "covariance-invented", &["{bad.g2o}", "--repair-information"]),
    case("clean", "everything-cut", &["{right.jsonl}", "--method", "multicut"]),
    case("clean", "no-support-within-delta", &["{right.jsonl}", "--method", "multicut"]),
    case("clean", "not-converged", &["{graph.jsonl}", "--method", "optimize --max-iterations 1"]),
    case("clean", "nothing-kept", &["{wrong.jsonl}"]),
    case("clean", "parts-not-connected", &["{wrong-apart.jsonl}"]),
    case("clean", "search-limit", &["{fewer.jsonl}"]),
    case("clean", "undetermined", &["{weak.jsonl}", "--method", "none"]),
    case(
        "construct",
        "covariance-invented",
        &[
            "{session.jsonl}",
            "--matches",
            "{matches.csv}",
            "--match-measurement",
            "identity",
            "--split",
            "none",
        ],
    ),
    case("convert", "covariance-invented", &["{bad.g2o}", "--repair-information", "--to", "jsonl"]),
    case(
        "evaluate",
        "parts-not-connected",
        &["{apart.jsonl}", "--reference", "{apart.jsonl}", "--scope", "per-component"],
    ),
    case("ingest", "covariance-invented", &["{2012-01-22}", "--sigma-translation", "0.1"]),
    case("isam", "not-converged", &["{tangle.jsonl}"]),
    case("isam", "parts-not-connected", &["{apart.jsonl}"]),
    case("islands", "nothing-kept", &["{right.jsonl}"]),
    case("multicut", "everything-cut", &["{costs.jsonl}", "--costs", "field"]),
    case("multicut", "everything-cut", &["{right.jsonl}"]),
    case("multicut", "no-support-within-delta", &["{right.jsonl}"]),
    case("multicut", "search-limit", &["{frustrated.jsonl}", "--costs", "field", "--work-limit", "1"]),
    case("multicut", "search-limit", &["{frustrated.jsonl}", "--costs", "field", "--solver", "gaec"]),
    case("optimize", "non-finite-cost", &["{huge.jsonl}", "--gnc"]),
    case("optimize", "not-certified", &["{fixed.jsonl}", "--certify"]),
    // The input is optimised, so its poses have a lower cost than the start.
    case(
        "optimize",
        "not-certified",
        &["{optimized.jsonl}", "--initialisation", "spanning-tree", "--max-iterations", "0"],
    ),
    case("optimize", "not-converged", &["{graph.jsonl}", "--max-iterations", "1"]),
    case("optimize", "nothing-kept", &["{wrong.jsonl}", "--gnc", "--reject-below", "0.5"]),
    case("optimize", "parts-not-connected", &["{apart.jsonl}"]),
    case("optimize", "undetermined", &["{weak.jsonl}"]),
    case("partition", "search-limit", &["solve", "{frustrated.mc}", "--work-limit", "1"]),
    case("partition", "search-limit", &["solve", "{frustrated.mc}", "--solver", "gaec"]),
    case("pcm", "calibration-on-prior", &["{right.jsonl}", "--scale", "auto"]),
    case("pcm", "nothing-kept", &["{wrong.jsonl}"]),
    case("pcm", "search-limit", &["{cliques.jsonl}", "--work-limit", "1"]),
    // The limit ends the search among hypotheses, or there are more occupied cells than allowed hypotheses.
    case(
        "pcm",
        "search-limit",
        &["{cliques.jsonl}", "--scheme", "cells", "--cell-size", "1", "--work-limit", "1"],
    ),
    case("pcm", "search-limit", &["{crowd.jsonl}", "--scheme", "cells", "--cell-size", "0.5"]),
    case("ransac", "nothing-kept", &["{right.jsonl}"]),
    case("ransac", "search-limit", &["{graph.jsonl}", "--most-trials", "1"]),
    case("readmit", "nothing-kept", &["{predicted.jsonl}"]),
    case(
        "recognize",
        "nothing-kept",
        &["{scans.jsonl}", "--exclusion-length", "7", "--least-agreement", "1"],
    ),
    case("verify", "calibration-on-prior", &["{right.jsonl}"]),
    case("verify", "nothing-kept", &["{wrong.jsonl}"]),
    case("verify", "parts-not-connected", &["{wrong-apart.jsonl}"]),
    case("verify", "search-limit", &["{fewer.jsonl}"]),
    case("voting", "nothing-kept", &["{wrong.jsonl}"]),
];

/// Programs that raise no doubts: they make or select data, know the truth, or report on other programs' results.
const WITHOUT: &[&str] = &[
    "conform",
    "densest",
    "doctor",
    "experiment",
    "inspect",
    "label",
    "map",
    "oracle",
    "report",
    "simulate",
    "simulate-graph",
    "simulate-log",
    "view",
];

impl Case {
    /// The exit status without `--strict`: `clean` is for people who do not know that option.
    fn status(&self) -> i32 {
        if self.program == "clean" { 3 } else { 0 }
    }

    /// Whether a line is a warning of the program, or of a stage that it runs.
    fn is_warning(&self, line: &str) -> bool {
        let stage = self
            .arguments
            .iter()
            .position(|word| *word == "--method")
            .and_then(|at| self.arguments[at + 1].split(' ').next());
        let of = |program: &str| line.starts_with(&format!("posecut-{program}: warning: "));
        of(self.program) || stage.is_some_and(of)
    }

    fn name(&self) -> String {
        format!("posecut-{} {}: {}", self.program, self.arguments.join(" "), self.doubt)
    }

    /// Runs the command; returns exit status, standard error, output and statistics.
    fn run(&self, more: &[&str]) -> (Option<i32>, String, Vec<u8>, Value) {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
        let (output, stats) = (file("out"), file("stats.json"));
        let replaced: Vec<String> = self
            .arguments
            .iter()
            .map(|word| match word.strip_prefix('{').and_then(|rest| rest.strip_suffix('}')) {
                Some(name) => path(name),
                None => (*word).to_owned(),
            })
            .collect();
        let mut arguments: Vec<&str> = replaced.iter().map(String::as_str).collect();
        arguments.extend(["-o", &output, "--stats", &stats]);
        arguments.extend(more);
        let ended = run(self.program, &arguments, b"");
        let said = String::from_utf8(ended.stderr).unwrap();
        let bytes = std::fs::read(&output).unwrap_or_else(|_| panic!("{}: no output: {said}", self.name()));
        let stats = serde_json::from_slice(&std::fs::read(&stats).unwrap()).unwrap();
        (ended.status.code(), said, bytes, stats)
    }
}

fn names(list: &Value) -> Vec<String> {
    list.as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned()).collect()
}

/// The doubts of the last stage in a graph's provenance.
fn signed(graph: &[u8]) -> Vec<String> {
    let header = graph.split(|&byte| byte == b'\n').next().unwrap();
    let header: Value = serde_json::from_slice(header).unwrap();
    header["provenance"].as_array().unwrap().last().unwrap().get("doubts").map_or_else(Vec::new, names)
}

/// The doubts that a program declares.
fn declared(program: &str) -> BTreeSet<String> {
    generated(&posecut_contract::program(program), "doubts").unwrap().lines().map(str::to_owned).collect()
}

#[test]
fn a_doubtful_result_says_so_and_fails_with_strict_alone() {
    for case in CASES {
        let name = case.name();
        let (status, said, output, stats) = case.run(&[]);
        assert_eq!(status, Some(case.status()), "{name}: {said}");
        let doubts = names(&stats["doubts"]);
        assert!(doubts.iter().any(|doubt| doubt == case.doubt), "{name}: {doubts:?}");
        assert!(declared(case.program).is_superset(&doubts.iter().cloned().collect()), "{name}: {doubts:?}");
        assert_eq!(doubts.iter().collect::<BTreeSet<_>>().len(), doubts.len(), "{name}: each once");
        let (status, quietly, again, _) = case.run(&["-q"]);
        assert_eq!((status, &again), (Some(case.status()), &output), "{name}");
        assert!(
            !quietly.is_empty() && quietly.lines().all(|line| case.is_warning(line)),
            "{name}: {quietly}"
        );
        assert!(quietly.lines().count() <= doubts.len(), "{name}: one warning for one thing: {quietly}");
        assert!(quietly.lines().all(|line| said.contains(line) && line.contains(';')), "{name}: {said}");
        let (status, _, again, strictly) = case.run(&["--strict"]);
        assert_eq!((status, &again), (Some(3), &output), "{name}: --strict");
        assert_eq!(strictly["doubts"], stats["doubts"], "{name}");
        // The outputs of these programs, and g2o, have no provenance.
        if !["evaluate", "partition"].contains(&case.program) && output.starts_with(b"{") {
            assert_eq!(signed(&output), doubts, "{name}: provenance");
        }
    }
}

#[test]
fn every_doubt_of_every_program_has_a_case_and_all_others_have_none() {
    let mut tried: BTreeMap<&str, BTreeSet<String>> =
        WITHOUT.iter().map(|&name| (name, BTreeSet::new())).collect();
    for case in CASES {
        tried.entry(case.program).or_default().insert(case.doubt.to_owned());
    }
    for program in programs() {
        assert_eq!(Some(&declared(&program)), tried.get(program.as_str()), "{program}");
        let silent = tried[program.as_str()].is_empty();
        let sentence =
            if silent { "This program raises no doubts." } else { "Doubts that this program may raise:" };
        assert!(
            generated(&posecut_contract::program(&program), "reference").unwrap().contains(sentence),
            "{program}: docs/cli.md"
        );
    }
    assert_eq!(tried.len(), programs().len(), "a program of the table does not exist");
}

/// Checks the rows of docs/doubts.md: a doubt in backquotes, then the programs that raise it.
#[test]
fn the_page_of_doubts_names_the_programs_of_each() {
    let page = std::fs::read_to_string(workspace().join("docs/doubts.md")).unwrap();
    let mut written: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for row in page.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let programs = cells[2].split(", ").map(str::to_owned).collect();
        written.insert(cells[1].trim_matches('`').to_owned(), programs);
    }
    let mut raised: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for program in programs() {
        for doubt in declared(&program) {
            raised.entry(doubt).or_default().insert(program.clone());
        }
    }
    assert_eq!(written, raised);
}

#[test]
fn a_good_result_raises_no_doubt() {
    // With --strict, doctor judges the graph and not its own result.
    for row in streams().filter(|row| row.name != "doctor") {
        let output = row.run(&["--strict"]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{}: {said}", row.name);
    }
}

#[test]
fn without_candidates_there_is_nothing_to_doubt() {
    for program in ["densest", "islands", "multicut", "pcm", "ransac", "readmit", "verify", "voting"] {
        for name in ["empty.jsonl", "odometry.jsonl"] {
            let output = run(program, &["--strict", &path(name)], b"");
            let said = String::from_utf8_lossy(&output.stderr);
            assert_eq!(output.status.code(), Some(0), "{program} {name}: {said}");
        }
    }
    let output = run("pcm", &["--strict", "--scale", "auto", &path("odometry.jsonl")], b"");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Regression: the cost of this start is zero up to rounding, and a cost of exactly zero counted as lower.
#[test]
fn costs_that_differ_by_rounding_are_no_local_minimum() {
    let arguments = ["-q", "--initialisation", "chordal", "--max-iterations", "0", &path("right.jsonl")];
    let output = run("optimize", &arguments, b"").stdout;
    assert_eq!(signed(&output), ["not-converged"]);
}

#[test]
fn doubts_stay_in_the_history_and_strict_is_about_one_run() {
    let doubtful = run("optimize", &["-q", &path("apart.jsonl")], b"").stdout;
    let next = run("multicut", &["--strict"], &doubtful);
    assert_eq!(next.status.code(), Some(0), "{}", String::from_utf8_lossy(&next.stderr));
    assert!(signed(&next.stdout).is_empty());
    let result = run("evaluate", &["-q", "--strict", "--reference", &path("apart.jsonl")], &next.stdout);
    assert_eq!(result.status.code(), Some(0), "{}", String::from_utf8_lossy(&result.stderr));
    let result: Value = serde_json::from_slice(&result.stdout).unwrap();
    assert_eq!(
        result["doubts"],
        serde_json::json!([{"stage": "optimize", "doubt": "parts-not-connected"}]),
        "the result carries the doubts of all stages"
    );
}

#[test]
fn strict_of_a_validation_is_about_warnings() {
    // The two components of this graph are not connected, and the validator warns of that.
    let lonely = path("apart.jsonl");
    let status = |more: &[&str]| run("inspect", &[&["validate", &lonely], more].concat(), b"").status.code();
    assert_eq!(status(&[]), Some(0));
    assert_eq!(status(&["--strict"]), Some(1));
    let early = run("inspect", &["--strict", "validate", &lonely], b"");
    assert_eq!(early.status.code(), Some(1), "{}", String::from_utf8_lossy(&early.stderr));
}

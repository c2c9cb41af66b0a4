//! `cargo xtask test-data`: regenerates a small simulated graph, and the expected output of the stages for it.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Context as _;
use clap::Args;
use serde_json::Value;
use xtask::workspace::{programs_folder, root};

use crate::Verdict;
use crate::process::must;

/// Regenerate testdata/, the expected results of the golden test
///
/// Run it after an intended change of results, and read the difference before you commit it.
#[derive(Args)]
pub(crate) struct TestData {
    /// Use the programs in this folder [default: the release build]
    programs: Option<PathBuf>,
}

impl TestData {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let programs = self.programs.unwrap_or_else(programs_folder);
        let work = tempfile::tempdir().context("no temporary folder can be created")?;
        let work = work.path();
        let call = |name: &str, words: &[&str], paths: &[(&str, &Path)]| {
            let mut command = Command::new(programs.join(format!("posecut-{name}")));
            command.arg("-q").args(words);
            for (option, path) in paths {
                command.args(Some(option).filter(|option| !option.is_empty())).arg(path);
            }
            must(&mut command)
        };
        let (folder, session) = (work.join("2012-01-22"), work.join("session.jsonl"));
        let testdata = root().join("testdata");
        let graph = testdata.join("graph.jsonl");
        call("simulate", &["--length", "1800", "--rate", "5", "--seed", "8"], &[("-o", &folder)])?;
        let sigmas = ["--keep-every", "15", "--sigma-translation", "0.3", "--sigma-rotation", "0.05"];
        call("ingest", &sigmas, &[("", &folder), ("-o", &session)])?;
        let edges = ["--radius", "5", "--heading", "45", "--incorrect-rate", "0.3"];
        call("construct", &edges, &[("", &session), ("-o", &graph)])?;

        let (marked, reference) = (work.join("oracle.jsonl"), work.join("reference.jsonl"));
        call("oracle", &[], &[("", &graph), ("-o", &marked)])?;
        call("optimize", &[], &[("", &marked), ("-o", &reference)])?;
        for method in ["pcm", "multicut"] {
            let (marked, optimized) = (work.join("marked.jsonl"), work.join("optimized.jsonl"));
            let stats = work.join("stats.json");
            call(method, &[], &[("", &graph), ("-o", &marked)])?;
            call("optimize", &[], &[("", &marked), ("-o", &optimized)])?;
            let to = [("", &*optimized), ("--reference", &*reference), ("-o", Path::new("/dev/null"))];
            call("evaluate", &[], &[&to[..], &[("--stats", &*stats)]].concat())?;
            let stats = std::fs::read_to_string(&stats)?;
            let lines: Vec<&str> = stats.lines().filter(|line| !line.contains("\"seconds\"")).collect();
            std::fs::write(testdata.join(format!("{method}.stats")), lines.join("\n") + "\n")?;
            let rejected = rejected(&std::fs::read_to_string(&marked)?, method)?;
            std::fs::write(testdata.join(format!("{method}.rejected")), rejected)?;
        }
        Ok(Verdict::Holds)
    }
}

/// The ids of the landmark edges that a method rejects, one per line.
fn rejected(graph: &str, method: &str) -> anyhow::Result<String> {
    let mut ids = String::new();
    for line in graph.lines() {
        let record: Value =
            serde_json::from_str(line).context("the output of the method is not JSON Lines")?;
        if record["kind"] == "landmark" && record["rejected_by"] == method {
            ids += &format!("{}\n", record["id"]);
        }
    }
    Ok(ids)
}

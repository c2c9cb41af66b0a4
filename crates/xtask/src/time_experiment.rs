//! `cargo xtask time-experiment`: measures the time of the paper's experiment, for docs/experiments.md.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::Context as _;
use clap::Args;
use serde::Deserialize;
use serde_json::Map;
use xtask::sections::replace;
use xtask::workspace::{programs_folder, root};

use crate::Verdict;
use crate::machine::today;
use crate::process::visibly;

/// Time a complete run of the paper's experiment on simulated sessions, with two threads
#[derive(Args)]
pub(crate) struct TimeExperiment {
    /// Use the programs in this folder [default: the release build]
    programs: Option<PathBuf>,
    /// Write the table into docs/experiments.md
    #[arg(long)]
    write: bool,
}

const SEEDS: u32 = 20;
const METHODS: [&str; 5] = ["none", "pcm", "gc", "pcm+gc", "oracle"];
const DOCUMENT: &str = "docs/experiments.md";

#[derive(Deserialize)]
struct Statistics {
    run: u64,
    seconds: f64,
    /// Stages in the order in which the runner reached them.
    stages: Map<String, serde_json::Value>,
}

#[derive(Deserialize)]
struct Stage {
    tasks: u64,
    seconds: f64,
}

impl TimeExperiment {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let programs = self.programs.map_or_else(|| Ok(programs_folder()), std::path::absolute)?;
        let work = tempfile::tempdir()?;
        let stats = work.path().join("stats.json");
        let mut run = Command::new(programs.join("posecut-experiment"));
        run.args(["run", "pipelines/paper.toml", "--quiet", "--threads", "2", "--seeds", &SEEDS.to_string()]);
        run.args(["--methods", &METHODS.join(",")]).arg("--results").arg(work.path().join("results"));
        run.arg("--simulated").arg(work.path().join("simulated")).arg("--stats").arg(&stats);
        visibly(run.current_dir(root()))?;
        let stats = serde_json::from_str(&std::fs::read_to_string(&stats)?)
            .context("posecut-experiment run --stats has no seconds of stages")?;
        let text = table(stats, results(work.path())?, &today()?)?;
        println!("{text}");
        if self.write {
            replace(&root().join(DOCUMENT), "time", &text)?;
        }
        Ok(Verdict::Holds)
    }
}

/// The number of results below a folder.
fn results(folder: &Path) -> anyhow::Result<usize> {
    let pattern = folder.join("**/*.result.json");
    Ok(glob::glob(&pattern.to_string_lossy())?.count())
}

fn table(statistics: Statistics, results: usize, date: &str) -> anyhow::Result<String> {
    let stages =
        statistics.stages.into_iter().map(|(name, stage)| Ok((name, serde_json::from_value(stage)?)));
    let mut stages: Vec<(String, Stage)> = stages.collect::<anyhow::Result<_>>()?;
    stages.sort_by(|one, other| other.1.seconds.total_cmp(&one.1.seconds));
    let mut text = format!(
        "{SEEDS} seeds, 4 simulated sessions, {} methods ({}), from nothing, on 2 cores ({date}): {} tasks and {results} \
         results in {:.1} s.\nWall time of whole processes:\n\n| stage | calls | seconds | milliseconds a call |\n|---|---|---|---|\n",
        METHODS.len(),
        METHODS.join(", "),
        statistics.run,
        statistics.seconds
    );
    for (name, Stage { tasks, seconds }) in stages {
        text += &format!("| {name} | {tasks} | {seconds:.1} | {:.0} |\n", 1000.0 * seconds / tasks as f64);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slowest_stage_comes_first() {
        let text = r#"{"run": 5, "seconds": 24.06, "stages":
            {"pcm": {"tasks": 80, "seconds": 2.0}, "optimize": {"tasks": 400, "seconds": 29.25}}}"#;
        let text = table(serde_json::from_str(text).unwrap(), 400, "2026-11-21").unwrap();
        assert_eq!(
            text,
            "20 seeds, 4 simulated sessions, 5 methods (none, pcm, gc, pcm+gc, oracle), from nothing, on 2 cores \
             (2026-11-21): 5 tasks and 400 results in 24.1 s.\nWall time of whole processes:\n\n\
             | stage | calls | seconds | milliseconds a call |\n|---|---|---|---|\n\
             | optimize | 400 | 29.2 | 73 |\n| pcm | 80 | 2.0 | 25 |\n"
        );
    }
}

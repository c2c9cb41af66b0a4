//! `cargo xtask regimes`: regenerates the tables of docs/results/regimes.md.

use std::path::PathBuf;
use std::process::Command;

use clap::Args;
use xtask::workspace::{from_root, program, root};

use crate::Verdict;
use crate::process::visibly;

/// Sweep pipelines/regimes.toml over real and simulated sessions, and regenerate docs/results/regimes.md
///
/// An interrupted sweep continues where it stopped. A complete sweep takes about an hour on two cores.
#[derive(Args)]
pub(crate) struct Regimes {
    /// Directory of NCLT sessions, such as data/nclt
    nclt: PathBuf,
}

const METHODS: &str = "none,pcm,pcm-root,pcm-calibrated,gc,pcm+gc,pcm-calibrated+gc";

impl Regimes {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let nclt = format!("NCLT={}", from_root(&self.nclt)?.display());
        for sessions in [&[nclt][..], &[]] {
            let mut make = Command::new("make");
            // make names each failed run, and the tables omit its point.
            if visibly(make.args(["--silent", "regimes"]).args(sessions).current_dir(root())).is_err() {
                eprintln!("some runs failed: the page omits their points");
            }
        }
        let mut report = Command::new(program("report"));
        report.args(["regimes", "results/regimes/results.jsonl", "results/regimes-simulated/results.jsonl"]);
        report.args(["--methods", METHODS, "--document", "docs/results/regimes.md"]);
        visibly(report.current_dir(root()))?;
        Ok(Verdict::Holds)
    }
}

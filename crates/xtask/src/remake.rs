//! `cargo xtask documentation`: regenerates the documents that are made from the programs.

use std::process::Command;

use anyhow::{Context as _, bail};
use clap::Args;
use xtask::documentation::pages;
use xtask::workspace::{program, programs, root};

use crate::Verdict;

/// Regenerate docs/cli.md, the option tables of READMEs and the schema from the release programs
#[derive(Args)]
pub(crate) struct Documentation {}

impl Documentation {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let Self {} = self;
        for page in pages(&programs()?, program, &schema()?)? {
            if !page.is_current() {
                page.write()?;
                println!("remade {}", page.path.display());
            }
        }
        Ok(Verdict::Holds)
    }
}

/// The schema of the format. An example of the format's crate prints it, so that xtask need not compile that crate.
fn schema() -> anyhow::Result<serde_json::Value> {
    let example =
        ["run", "--release", "--quiet", "--locked", "--package", "posecut-graph", "--example", "schema"];
    let output = Command::new("cargo").args(example).current_dir(root()).output().context("cargo")?;
    if !output.status.success() {
        bail!("cargo {}: {}", example.join(" "), String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(serde_json::from_slice(&output.stdout)?)
}

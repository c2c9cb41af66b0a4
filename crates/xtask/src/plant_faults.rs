//! `cargo xtask plant-faults`: checks that `make check-results` blames a planted fault on its stage, for
//! docs/experiments.md.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail};
use clap::Args;
use xtask::sections::replace;
use xtask::workspace::root;

use crate::Verdict;
use crate::process::{must, visibly};

/// Plant faults, each one changed line in a copy of the sources, and check that `make check-results` blames its stage
#[derive(Args)]
pub(crate) struct PlantFaults {
    /// Plant only the faults of these stages: pcm, multicut, construct
    stages: Vec<String>,
    /// Write the output of the check into docs/experiments.md
    #[arg(long)]
    write: bool,
}

const DOCUMENT: &str = "docs/experiments.md";
const WIDTH: usize = 160;
/// The folder below the root in which copies are built.
const COPY: &str = "target/faulty";

struct Fault {
    stage: &'static str,
    file: &'static str,
    right: &'static str,
    wrong: &'static str,
}

const FAULTS: [Fault; 3] = [
    Fault {
        stage: "pcm",
        file: "crates/pcm/src/pairs/gate.rs",
        right: "let quantile = chi_square_quantile(probability, degrees_of_freedom)?;",
        wrong: "let quantile = 2.0 * chi_square_quantile(probability, degrees_of_freedom)?;",
    },
    Fault {
        stage: "multicut",
        file: "crates/multicut/src/stage.rs",
        right: "(_, 0) => -1.0,",
        wrong: "(_, 0) => 1.0,",
    },
    Fault {
        stage: "construct",
        file: "crates/construct/src/landmark.rs",
        right: "|&(from, to)| viewpoints[from].pose.between(&viewpoints[to].pose)",
        wrong: "|&(from, to)| viewpoints[to].pose.between(&viewpoints[from].pose)",
    },
];

impl PlantFaults {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        if let Some(name) = self.stages.iter().find(|name| !FAULTS.iter().any(|fault| fault.stage == *name)) {
            bail!("no fault is known for {name}; there is one for pcm, multicut and construct");
        }
        let asked =
            |fault: &&Fault| self.stages.is_empty() || self.stages.iter().any(|stage| stage == fault.stage);
        for fault in FAULTS.iter().filter(asked) {
            let Some(text) = fault.blamed(&fault.plant()?)? else {
                eprintln!("the check does not blame the stage {} for its fault", fault.stage);
                return Ok(Verdict::Fails);
            };
            println!("{text}\n");
            if self.write {
                replace(&root().join(DOCUMENT), fault.stage, &format!("```\n{text}\n```\n"))?;
            }
        }
        Ok(Verdict::Holds)
    }
}

impl Fault {
    /// Builds a program from a copy of the sources with one changed line, and returns its path from the root.
    fn plant(&self) -> anyhow::Result<PathBuf> {
        let copy = root().join(COPY);
        let sources = copy.join("sources");
        if sources.exists() {
            std::fs::remove_dir_all(&sources)?;
        }
        std::fs::create_dir_all(&sources)?;
        let mut cp = Command::new("cp");
        must(cp.arg("-R").args(["Cargo.toml", "Cargo.lock", "crates"]).arg(&sources).current_dir(root()))?;
        let path = sources.join(self.file);
        let text =
            std::fs::read_to_string(&path).with_context(|| format!("{}: cannot be read", self.file))?;
        let times = text.matches(self.right).count();
        if times != 1 {
            bail!(
                "{}: must contain this text once, but contains it {times} times: {}",
                self.file,
                self.right
            );
        }
        std::fs::write(&path, text.replace(self.right, self.wrong))?;
        let target = copy.join("target");
        let name = format!("posecut-{}", self.stage);
        let mut cargo = Command::new("cargo");
        cargo.args(["build", "--release", "--locked", "--quiet", "-p", &name, "--target-dir"]).arg(&target);
        visibly(cargo.current_dir(&sources))?;
        std::fs::copy(target.join("release").join(&name), copy.join(&name))?;
        Ok(Path::new(COPY).join(name))
    }

    /// The output of the check if it blames this stage with this program; `None` if it blames another stage or none.
    fn blamed(&self, program: &Path) -> anyhow::Result<Option<String>> {
        let results = Path::new(COPY).join("results");
        if root().join(&results).exists() {
            std::fs::remove_dir_all(root().join(&results))?;
        }
        let mut make = Command::new("make");
        make.args(["check-results", "PIPELINES=paper", "SEEDS=1"])
            .arg(format!("RESULTS={}", results.display()));
        make.arg(format!("{}={}", self.stage.to_uppercase(), program.display())).current_dir(root());
        let output = make.output().context("make cannot be started")?;
        let said =
            [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned()).concat();
        let blamed = excerpt(&said, self.stage).filter(|_| !output.status.success());
        if blamed.is_none() {
            println!("{said}");
        }
        Ok(blamed)
    }
}

/// The lines from the one that blames the stage to the one that says what to do, cut at the width.
fn excerpt(said: &str, stage: &str) -> Option<String> {
    let lines: Vec<&str> = said.lines().collect();
    let start = lines.iter().position(|line| line.starts_with("FAILED in stage"))?;
    let end = lines.iter().position(|line| line.starts_with("If the change is intended"))?;
    lines.get(start).filter(|line| line.contains(&format!("`{stage}`")))?;
    let cut = |line: &&str| match line.chars().count() {
        0..=WIDTH => (*line).to_owned(),
        _ => line.chars().take(WIDTH - 1).chain(['…']).collect(),
    };
    Some(lines.get(start..=end)?.iter().map(cut).collect::<Vec<_>>().join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_excerpt_starts_where_the_stage_is_blamed() {
        let long = "x".repeat(200);
        let said =
            format!("before\nFAILED in stage `pcm`: 1 file\n{long}\nIf the change is intended, …\nafter\n");
        let text = excerpt(&said, "pcm").unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert_eq!(lines[1], "x".repeat(159) + "…");
        assert_eq!(excerpt(&said, "multicut"), None);
        assert_eq!(excerpt("nothing failed\n", "pcm"), None);
    }
}

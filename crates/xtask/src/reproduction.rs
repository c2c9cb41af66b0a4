//! `cargo xtask reproduction`: regenerates every table of docs/results/reproduction.md.

mod difference;
mod odometry;

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context as _, bail};
use clap::Args;
use xtask::sections::replace;
use xtask::workspace::{from_root, root};

use crate::Verdict;
use crate::process::visibly;

/// Run the experiments of docs/results/reproduction.md, and regenerate its tables
#[derive(Args)]
pub(crate) struct Reproduction {
    /// Directory of NCLT sessions, such as data/nclt
    nclt: PathBuf,
    /// Regenerate only these tables, by the names of their sections
    #[arg(long, num_args = 1..)]
    only: Vec<String>,
}

const DOCUMENT: &str = "docs/results/reproduction.md";
const RESULTS: &str = "results/reproduction";
const SESSIONS: [&str; 5] = ["2012-01-08", "2012-01-22", "2012-08-04", "2012-11-16", "2013-02-23"];
const CHANCE: &str = "METHODS=none pcm pcm-chance pcm+gc pcm-chance+gc";

/// How to make a section.
enum Section {
    /// `make table` on real sessions, with additional variables.
    Real(&'static [&'static str]),
    /// The same on simulated sessions.
    Simulated(&'static [&'static str]),
    /// The difference between the tables of two other sections.
    Difference(&'static str, &'static str),
    /// NEES of the odometry.
    Odometry,
}

const SECTIONS: [(&str, Section); 11] = [
    ("simulated", Section::Simulated(&[])),
    ("real", Section::Real(&[])),
    // The paper's solver, and how much it changes the results.
    ("isam2", Section::Real(&["OPTIMIZE=target/release/posecut-isam"])),
    ("isam2-difference", Section::Difference("real", "isam2")),
    // The pseudo ground truth is computed after PCM.
    ("after-pcm", Section::Real(&["PIPELINES=paper-after-pcm calibrated-after-pcm"])),
    ("nees", Section::Odometry),
    ("chance-simulated", Section::Simulated(&[CHANCE])),
    ("chance", Section::Real(&[CHANCE])),
    // The table omits 2012-11-16: only edges across the cut join its halves.
    (
        "seam",
        Section::Real(&[
            "SESSIONS=2012-01-08 2012-01-22 2012-08-04 2013-02-23",
            "METHODS=pcm pcm+gc",
            "paper.construct=--split middle --minimum-interval 60 --incorrect-rate 0.1",
            "calibrated.construct=--split middle --minimum-interval 60 --incorrect-rate 0.1",
        ]),
    ),
    (
        "root",
        Section::Real(&[
            "PIPELINES=calibrated",
            "METHODS=none pcm gc pcm+gc",
            "calibrated.pcm=--test root --probability 0.99",
        ]),
    ),
    (
        "space",
        Section::Real(&[
            "METHODS=pcm pcm+gc",
            "paper.ingest=--dimension 3 --sigma-translation 0.3 --sigma-rotation 0.05",
            "calibrated.ingest=--dimension 3 --sigma-translation 0.1 --sigma-rotation 0.02",
            "paper.evaluate=--align se3",
            "calibrated.evaluate=--align se3",
        ]),
    ),
];

impl Reproduction {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        if let Some(name) = self.only.iter().find(|name| !SECTIONS.iter().any(|(known, _)| known == name)) {
            let known: Vec<&str> = SECTIONS.iter().map(|(name, _)| *name).collect();
            bail!("{DOCUMENT}: has no table {name}; name one of {}", known.join(", "));
        }
        let nclt = from_root(&self.nclt)?;
        for (name, section) in &SECTIONS {
            if self.only.is_empty() || self.only.iter().any(|asked| asked == name) {
                let text = text(name, section, &nclt)?;
                replace(&root().join(DOCUMENT), name, &text)?;
            }
        }
        Ok(Verdict::Holds)
    }
}

fn text(name: &str, section: &Section, nclt: &Path) -> anyhow::Result<String> {
    let folder = format!("{RESULTS}/{name}");
    let mut given = vec!["SEEDS=5".to_owned(), format!("RESULTS={folder}")];
    let (more, file) = match section {
        Section::Odometry => return odometry::table(&root().join(nclt), &SESSIONS),
        Section::Difference(first, second) => {
            let table = |name: &str| root().join(RESULTS).join(name).join("table.csv");
            return difference::table(&table(first), &table(second));
        }
        Section::Real(more) => {
            given.extend([format!("NCLT={}", nclt.display()), format!("SESSIONS={}", SESSIONS.join(" "))]);
            (more, "table.md")
        }
        Section::Simulated(more) => (more, "table-simulated.md"),
    };
    let mut make = Command::new("make");
    make.args(["--silent", "-j2", "table"]).args(given);
    // make uses the last value of a repeated variable.
    make.args(*more).current_dir(root()).stdout(Stdio::null());
    visibly(&mut make)?;
    let path = root().join(folder).join(file);
    std::fs::read_to_string(&path).with_context(|| format!("{}: cannot be read", path.display()))
}

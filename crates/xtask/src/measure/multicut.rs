//! Measures posecut-partition, the multicut solver, as a whole process on generated and published instances, for
//! docs/results/multicut.md.

mod instances;
mod running;
mod tables;

use std::collections::HashMap;
use std::ffi::{OsStr, OsString};
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use anyhow::Context as _;
use clap::{Args, ValueEnum};
use xtask::sections::replace;
use xtask::workspace::root;

use crate::Verdict;
use crate::machine::{Machine, today};
use crate::measure::peers::python;
use crate::measure::programs::build;
use crate::process::visibly;
use instances::{Instance, instances, small_and_hard};
use running::{Found, Limits, Wanted, measure};

/// Measure posecut-partition, the multicut solver, as a whole process on generated and published instances
///
/// Builds the release program, generates graphs of the families F, S, A (10^3 to N viewpoints) and D (to 10^5) with 10, 50 and 90 %
/// false edges, and adds every instance of $POSECUT_SHARED_DATA/multicut. CPU seconds and peak memory are those that the system
/// counts for the whole process, including reading and writing, on one thread. Small and hard instances are measured for a section of
/// their own: unions of random graphs, cluster editing, and $POSECUT_SHARED_DATA/multicut/cplib. Regenerates the sections of
/// docs/results/multicut.md.
#[derive(Args)]
pub(crate) struct Multicut {
    /// Generate graphs of up to this many viewpoints
    #[arg(long, default_value_t = 1_000_000)]
    largest: u64,
    /// Run the peer on generated graphs of up to this many viewpoints
    #[arg(long, default_value_t = 1_000_000)]
    largest_peer: u64,
    /// Measure and rewrite only this part
    #[arg(long, value_enum, default_value_t = Part::All)]
    part: Part,
    /// Also measure GAEC and GAEC + KL of bioimage-cpp, with this Python that has the package; without a value, its newest release is
    /// installed in target/python
    #[arg(long, value_name = "PYTHON", num_args = 0..=1, default_missing_value = "")]
    // Not a path, which must not be empty.
    peer: Option<OsString>,
    /// Stop after this many seconds on each published instance
    #[arg(long, default_value_t = 60)]
    time_limit: u64,
    /// Stop after this many seconds on each generated instance
    #[arg(long, default_value_t = 60)]
    generated_limit: u64,
    /// Stop each run of the peer after this many seconds
    #[arg(long, default_value_t = 120)]
    peer_limit: u64,
    /// Keep measurements in this file, one JSON object per instance, and reuse those that it has
    #[arg(long, value_name = "FILE")]
    measured: Option<PathBuf>,
    /// Measure only instances with this text in their names
    #[arg(long, default_value = "", value_name = "TEXT")]
    only: String,
    /// Start no measurement after this many seconds
    #[arg(long, value_name = "SECONDS")]
    r#for: Option<f64>,
    /// Write into the sections of this document [default: docs/results/multicut.md]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Parts of the document.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Part {
    /// Every section
    All,
    /// Sections about the heuristics beside the peer
    Heuristics,
    /// The section about small and hard instances
    Hard,
}

impl Multicut {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        build(&["-p", "posecut-partition", "-p", "posecut-multicut", "--bins", "--example", "generate_mc"])?;
        let folder = tempfile::tempdir()?;
        let document = self.output.clone().unwrap_or_else(|| root().join("docs/results/multicut.md"));
        if self.part != Part::Hard {
            self.measure_all(&document, folder.path())?;
        }
        if self.part != Part::Heuristics {
            self.measure_hard(&document, folder.path())?;
        }
        Ok(Verdict::Holds)
    }

    /// Everything but small and hard instances.
    fn measure_all(&self, document: &Path, folder: &Path) -> anyhow::Result<()> {
        let instances = self.chosen(instances(self.largest, folder)?);
        let python = self.peer.as_deref().map(peer_python).transpose()?;
        let found = self.found(&instances, python.as_deref(), folder)?;
        replace(document, "heuristics-summary", &tables::summary_of_heuristics(&found))?;
        replace(document, "heuristics", &tables::heuristics(&found, self.peer_limit))?;
        let conditions = self.conditions(&Machine::here(), &today()?, &missing(&instances, &found));
        if self.part == Part::Heuristics {
            return replace(document, "heuristics-measured", &conditions);
        }
        replace(document, "summary", &tables::summary(&found))?;
        replace(document, "measured", &conditions)?;
        replace(document, "heuristics-measured", "Measured in the same run.")?;
        replace(document, "growth", &tables::growth(&found))?;
        replace(document, "exact", &tables::exact(&found))
    }

    fn measure_hard(&self, document: &Path, folder: &Path) -> anyhow::Result<()> {
        let instances = self.chosen(small_and_hard(folder)?);
        let found = self.found(&instances, None, folder)?;
        let conditions = self.conditions(&Machine::here(), &today()?, &missing(&instances, &found));
        let known = |found: &Found| instances.iter().find(|instance| instance.name == found.name)?.known;
        let known: Vec<Option<f64>> = found.iter().map(known).collect();
        replace(document, "hard", &format!("{conditions}\n{}", tables::hard(&found, &known)))
    }

    fn chosen(&self, mut instances: Vec<Instance>) -> Vec<Instance> {
        instances.retain(|instance| instance.name.contains(&self.only));
        instances
    }

    /// Measurements, old and new, in the order of the instances.
    fn found(
        &self,
        instances: &[Instance],
        python: Option<&Path>,
        folder: &Path,
    ) -> anyhow::Result<Vec<Found>> {
        let began = Instant::now();
        let mut known = self.known()?;
        let mut all = Vec::new();
        for instance in instances {
            let in_time = self.r#for.is_none_or(|seconds| began.elapsed().as_secs_f64() < seconds);
            let found = match known.remove(&instance.name) {
                Some(found) => found,
                None if in_time => self.measure(instance, python, folder)?,
                None => continue,
            };
            all.push(found);
        }
        Ok(all)
    }

    fn known(&self) -> anyhow::Result<HashMap<String, Found>> {
        let Some(path) = self.measured.as_ref().filter(|path| path.exists()) else {
            return Ok(HashMap::new());
        };
        let place = || format!("{}: cannot be used", path.display());
        let text = std::fs::read_to_string(path).with_context(place)?;
        let found = |line: &str| {
            let found: Found = serde_json::from_str(line).with_context(place)?;
            Ok((found.name.clone(), found))
        };
        text.lines().map(found).collect()
    }

    fn measure(&self, instance: &Instance, python: Option<&Path>, folder: &Path) -> anyhow::Result<Found> {
        eprintln!("{}", instance.name);
        instance.generate()?;
        let peer = python.filter(|_| instance.viewpoints.is_none_or(|size| size <= self.largest_peer));
        let own = if instance.viewpoints.is_some() { self.generated_limit } else { self.time_limit };
        let limits = Limits { own, peer: self.peer_limit };
        let wanted = Wanted { exact: self.part != Part::Heuristics, peer, limits };
        let found = measure(instance, wanted, folder)?;
        if let Some(path) = &self.measured {
            let mut file = OpenOptions::new().create(true).append(true).open(path)?;
            writeln!(file, "{}", serde_json::to_string(&found)?)?;
        }
        Ok(found)
    }

    /// The date, machine and limits of the measurement, and what is missing.
    fn conditions(&self, machine: &Machine, date: &str, missing: &[&str]) -> String {
        let options = [
            ("--largest", self.largest),
            ("--largest-peer", self.largest_peer),
            ("--peer-limit", self.peer_limit),
            ("--generated-limit", self.generated_limit),
            ("--time-limit", self.time_limit),
        ];
        let options: Vec<String> =
            options.iter().map(|(option, value)| format!("{option} {value}")).collect();
        let system = if cfg!(target_os = "linux") { "Linux" } else { std::env::consts::OS };
        let mut text = format!(
            "Measured {date} on {} cores, {}, {system} {}, one thread. Made by:\n\n    cargo xtask measure multicut {}{}\n",
            machine.cores,
            machine.model,
            std::env::consts::ARCH,
            options.join(" "),
            match self.part {
                Part::All => "",
                Part::Heuristics => " --part heuristics",
                Part::Hard => " --part hard",
            }
            .to_owned()
                + if self.peer.is_some() { " --peer" } else { "" }
        );
        if !missing.is_empty() {
            text += &format!("\nNot measured: {}.\n", missing.join(", "));
        }
        text
    }
}

/// The instances without measurement.
fn missing<'a>(instances: &'a [Instance], found: &[Found]) -> Vec<&'a str> {
    let names = instances.iter().map(|instance| instance.name.as_str());
    names.filter(|name| !found.iter().any(|found| found.name == *name)).collect()
}

/// The Python of the peer: the given one, or that of target/python with the newest release.
fn peer_python(given: &OsStr) -> anyhow::Result<PathBuf> {
    if !given.is_empty() {
        return Ok(given.into());
    }
    let python = python(&["bioimage_cpp", "numpy"])?;
    visibly(Command::new(&python).args(["-m", "pip", "install", "--quiet", "--upgrade", "bioimage-cpp"]))?;
    Ok(python)
}

//! Counts the ingredients of the proofs of posecut-partition, for crates/multicut/docs/method.md.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail};
use clap::Args;
use serde::Deserialize;
use xtask::sections::replace;
use xtask::workspace::{program, programs_folder};

use crate::Verdict;
use crate::markdown;
use crate::numbers::general;
use crate::process::must;
use crate::twister::Twister;

/// Count branchings, fixed edges and packed wheels in the certificates of posecut-partition
///
/// Runs every program on the small instances of $POSECUT_SHARED_DATA/multicut, on generated graphs of 1,000 viewpoints, and on
/// complete and on sparse random graphs with costs drawn uniformly from -1 to 1. To measure the effect of a change, name a build from
/// before and one from after it. The first program verifies each certificate.
#[derive(Args)]
pub(crate) struct Proofs {
    /// Measure this program; may be repeated [default: the release build, as "now"]
    #[arg(long, value_name = "NAME=PATH")]
    program: Vec<String>,
    /// Stop after this many seconds on each instance
    #[arg(long, default_value_t = 10)]
    time_limit: u32,
    /// Write the table into the section `wheels` of this document
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,
}

/// An instance with more lines than this is not small.
const LARGEST: usize = 25_000;

/// The statistics of `--stats`.
#[derive(Deserialize)]
struct Statistics {
    lower_bound: f64,
    optimal: bool,
    work: f64,
}

/// The result of one program on one instance.
#[derive(PartialEq)]
struct Proof {
    /// Numbers of branchings, fixings and wheels, and the bound.
    kinds: String,
    open: bool,
    work: f64,
}

impl Proofs {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let programs = self.programs()?;
        let folder = tempfile::tempdir()?;
        let mut lines = vec![head(&programs), format!("|---|{}", "---|".repeat(5 * programs.len()))];
        let mut same = 0;
        for (instance, path) in instances(folder.path())? {
            let proof =
                |(_, program): &(String, PathBuf)| self.proof(program, &programs[0].1, &path, folder.path());
            let proofs: Vec<Proof> = programs.iter().map(proof).collect::<anyhow::Result<_>>()?;
            if proofs.len() > 1
                && !proofs[0].open
                && proofs.iter().all(|proof| proof.kinds == proofs[0].kinds)
            {
                same += 1;
                continue;
            }
            let cell = |proof: &Proof| format!("{} | {}", proof.kinds, general(proof.work / 1e6, 3));
            let mut cells = vec![instance];
            cells.extend(proofs.iter().map(cell));
            lines.push(markdown::row(&cells));
            eprintln!("{}", lines[lines.len() - 1]);
        }
        if programs.len() > 1 {
            lines.extend([String::new(), format!("On {same} other instances the proofs are alike.")]);
        }
        let text = lines.join("\n");
        println!("{text}");
        if let Some(document) = &self.write {
            replace(document, "wheels", &text)?;
        }
        Ok(Verdict::Holds)
    }

    fn programs(&self) -> anyhow::Result<Vec<(String, PathBuf)>> {
        let named = |text: &String| {
            let Some((name, path)) = text.split_once('=') else {
                bail!("--program {text}: is not NAME=PATH")
            };
            Ok((name.to_owned(), PathBuf::from(path)))
        };
        let given: Vec<_> = self.program.iter().map(named).collect::<anyhow::Result<_>>()?;
        Ok(if given.is_empty() { vec![("now".to_owned(), program("partition"))] } else { given })
    }

    fn proof(
        &self,
        program: &Path,
        verifier: &Path,
        instance: &Path,
        folder: &Path,
    ) -> anyhow::Result<Proof> {
        let (stats, certificate) = (folder.join("stats.json"), folder.join("certificate"));
        let mut solve = Command::new(program);
        solve.arg("solve").arg(instance).args(["--time-limit", &self.time_limit.to_string()]);
        solve.args(["--threads", "1", "-q", "-o", "/dev/null", "--stats"]).arg(&stats);
        must(solve.arg("--certificate").arg(&certificate))?;
        let mut verify = Command::new(verifier);
        must(verify.args(["verify", "-q"]).arg(&certificate).arg(instance))?;
        let certificate = std::fs::read_to_string(&certificate)?;
        let count =
            |word: &str| certificate.lines().filter(|line| line.split(' ').next() == Some(word)).count();
        let found: Statistics = serde_json::from_str(&std::fs::read_to_string(&stats)?)
            .with_context(|| format!("{}: --stats has no bound", program.display()))?;
        let open = if found.optimal { "" } else { " (open)" };
        let bound = general(found.lower_bound, 10);
        let kinds = format!("{} | {} | {} | {bound}{open}", count("branch"), count("fix"), count("wheel"));
        Ok(Proof { kinds, open: !found.optimal, work: found.work })
    }
}

fn head(programs: &[(String, PathBuf)]) -> String {
    let mut cells = vec!["instance".to_owned()];
    let columns = |name: &String| format!("{name}: branchings | fixings | wheels | bound | work, millions");
    cells.extend(programs.iter().map(|(name, _)| columns(name)));
    markdown::row(&cells)
}

/// Names and files of all instances.
fn instances(folder: &Path) -> anyhow::Result<Vec<(String, PathBuf)>> {
    let mut all = published()?;
    for (family, rate) in [("A", "0.5"), ("A", "0.9"), ("D", "0.1"), ("D", "0.5")] {
        let path = folder.join(format!("{family}{rate}.mc"));
        must(
            Command::new(programs_folder().join("examples/generate_mc"))
                .args([family, "1000", rate, "1"])
                .arg(&path),
        )?;
        all.push((format!("{family} n=1000 {rate}"), path));
    }
    for (nodes, share) in [(20, 1.0), (30, 1.0), (40, 1.0), (60, 0.2), (120, 0.08)] {
        for seed in [1, 2] {
            let path = folder.join(format!("random-{nodes}-{seed}.mc"));
            draw(&path, nodes, share, seed)?;
            all.push((format!("random, {nodes} nodes, {:.0}%, seed {seed}", 100.0 * share), path));
        }
    }
    Ok(all)
}

/// The small instances among the published ones.
fn published() -> anyhow::Result<Vec<(String, PathBuf)>> {
    let Some(data) = std::env::var_os("POSECUT_SHARED_DATA") else {
        eprintln!("skipped: no data: multicut (set POSECUT_SHARED_DATA)");
        return Ok(Vec::new());
    };
    let pattern = Path::new(&data).join("multicut/*.mc");
    let mut found = Vec::new();
    for path in glob::glob(&pattern.to_string_lossy())? {
        let path = path?;
        let lines = BufReader::new(std::fs::File::open(&path)?).lines().take(LARGEST).count();
        if (1..LARGEST).contains(&lines) {
            found.push((path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), path));
        }
    }
    Ok(found)
}

/// A random graph: each pair of nodes has an edge with probability `share`, with a cost drawn uniformly from -1 to 1.
fn draw(path: &Path, nodes: u32, share: f64, seed: u32) -> anyhow::Result<()> {
    let mut chance = Twister::new(seed);
    let mut file = std::io::BufWriter::new(std::fs::File::create(path)?);
    writeln!(file, "MULTICUT")?;
    for head in 0..nodes {
        for tail in 0..head {
            if chance.random() < share {
                writeln!(file, "{tail} {head} {:.6}", chance.uniform(-1.0, 1.0))?;
            }
        }
    }
    Ok(file.flush()?)
}

//! Runs all optimisers on the same graphs, one after the other, from every start.

mod starts;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use xtask::workspace::{root, target};

use super::pinned::{Pinned, work};
use super::{Named, Results, best, named};
use crate::markdown;
use crate::measure::peers::{python, script};
use crate::measure::programs;
use crate::numbers::{general, scientific};
use starts::starts;

const SOLVERS: [&str; 6] = ["posecut", "arael", "factrs", "apex", "tiny", "gtsam"];
/// The solvers whose times come close. Other work on the machine slows some seconds down, so these run in several rounds, in turn.
const FASTEST: [&str; 2] = ["posecut", "arael"];
const ROUNDS: usize = 5;
/// Runs in a process, fewer if they take more than three seconds.
const REPEATS: &str = "10";
/// A solver has found the minimum if its cost is at most this share above the best known one. This allows for its own
/// definition of the cost, which is not quite ours.
const FOUND: f64 = 1e-2;

/// The result of one solver from one start.
#[derive(Deserialize, Serialize)]
pub(super) struct Entry {
    failed: Option<String>,
    seconds: Option<f64>,
    iterations: Option<u64>,
    megabytes: Option<f64>,
    /// The cost in the log convention, as posecut-optimize computes it; `None` if the poses are not finite.
    cost: Option<f64>,
}

impl Entry {
    /// The cost minus the best known one, as a share of the latter; infinite without a cost.
    fn gap(&self, best: f64) -> f64 {
        self.cost.filter(|cost| cost.is_finite()).map_or(f64::INFINITY, |cost| (cost - best) / best)
    }
}

#[derive(Deserialize)]
#[serde(transparent)]
pub(super) struct Graphs(#[serde(deserialize_with = "named")] Named<Starts>);

#[derive(Deserialize)]
#[serde(transparent)]
struct Starts(#[serde(deserialize_with = "named")] Named<Solvers>);

#[derive(Deserialize)]
#[serde(transparent)]
struct Solvers(#[serde(deserialize_with = "named")] Named<Entry>);

impl Solvers {
    fn of(&self, solver: &str) -> anyhow::Result<&Entry> {
        let found = self.0.iter().find(|(name, _)| name == solver);
        found.map(|(_, entry)| entry).with_context(|| format!("comparison.json: {solver} was not measured"))
    }
}

/// The folder of another build of the peers than this measurement makes, if any.
fn given_folder() -> Option<PathBuf> {
    std::env::var_os("PEERS").map(PathBuf::from)
}

/// Builds the program that contains most of the other optimisers, and posecut.
pub(super) fn build() -> anyhow::Result<()> {
    if given_folder().is_some() {
        return Ok(());
    }
    let folder = target().join("peers").display().to_string();
    programs::build(&["--manifest-path", "crates/optimize/peers/Cargo.toml", "--target-dir", &folder])
}

/// The program that contains most of the other optimisers.
fn peers_program() -> anyhow::Result<PathBuf> {
    let folder = given_folder().unwrap_or_else(|| target().join("peers"));
    let program = root().join(folder).join("release/posecut-optimize-peers");
    if !program.exists() {
        bail!(
            "{} is missing; set PEERS to the folder of a build of crates/optimize/peers, or unset it",
            program.display()
        );
    }
    Ok(program)
}

pub(super) fn measure(name: &str, results: &mut Results) -> anyhow::Result<()> {
    let (peers, gtsam) = (peers_program()?, python(&["gtsam"])?);
    for (start, path) in starts(name)? {
        let mut least: BTreeMap<&str, Value> = BTreeMap::new();
        for round in 0..ROUNDS {
            for solver in SOLVERS.into_iter().filter(|solver| round == 0 || FASTEST.contains(solver)) {
                // The others lack the relaxation, so posecut too starts from its result as given.
                let word = if (solver, start) == ("posecut", "chordal") { "posecut-given" } else { solver };
                let command = match solver {
                    "gtsam" => Pinned::new(&gtsam, 1).path(script("gtsam")),
                    _ => Pinned::new(&peers, 1).words(&[word]),
                };
                let entry = run(command, name, &path, &format!("{name}.{start}.{solver}"))?;
                println!("{name} {start} {solver} {entry}");
                let seconds = |entry: &Value| entry["seconds"].as_f64().unwrap_or(f64::INFINITY);
                if least.get(solver).is_none_or(|before| seconds(&entry) < seconds(before)) {
                    least.insert(solver, entry);
                }
            }
        }
        for (solver, entry) in least {
            results.keep(&["peers", name, start, solver], entry)?;
        }
    }
    Ok(())
}

/// What a solver says of its runs on one file, and the cost of what it writes to the file of this `label`.
fn run(command: Pinned, name: &str, path: &Path, label: &str) -> anyhow::Result<Value> {
    let target = work().join(format!("{label}.g2o"));
    let run = match command.path(path).path(&target).words(&[REPEATS]).run()? {
        Err(why) => return Ok(json!({"failed": why})),
        Ok(run) => run,
    };
    let output = String::from_utf8_lossy(&run.output);
    let last = output.lines().last().unwrap_or_default();
    let mut said: Value =
        serde_json::from_str(last).with_context(|| format!("{label}, a run on {name}: {last}"))?;
    said["megabytes"] = json!(run.peak as f64 / f64::from(1 << 20));
    said["cost"] = json!(cost_of(&target)?);
    Ok(said)
}

/// The cost of a g2o graph's poses in the log convention; `None` if they are not finite.
fn cost_of(path: &Path) -> anyhow::Result<Option<f64>> {
    let (stats, graph, output) =
        (work().join("cost.json"), work().join("cost.jsonl"), work().join("cost.out.jsonl"));
    if Pinned::posecut("convert").path(path).words(&["-o"]).path(&graph).run()?.is_err() {
        return Ok(None);
    }
    let optimize = Pinned::posecut("optimize").words(&["--initialisation", "given", "--max-iterations", "0"]);
    let ended = optimize.path(&graph).words(&["-o"]).path(&output).words(&["--stats"]).path(&stats).run()?;
    if ended.is_err() {
        return Ok(None);
    }
    let stats: Value = serde_json::from_str(&std::fs::read_to_string(&stats)?)?;
    Ok(stats["chi_square_given"].as_f64())
}

/// The number of poses of a graph, counted in the file that the solvers read.
pub(super) fn poses(name: &str) -> anyhow::Result<usize> {
    let path = work().join(format!("{name}.file.g2o"));
    let text = std::fs::read_to_string(&path).with_context(|| {
        format!("{}: cannot be read; measure the part peers of {name} again", path.display())
    })?;
    Ok(text.lines().filter(|line| line.starts_with("VERTEX")).count())
}

fn cell(entry: &Entry, best: f64) -> String {
    let gap = entry.gap(best);
    let (Some(seconds), None, true) = (entry.seconds, &entry.failed, gap.is_finite()) else {
        return entry.failed.clone().filter(|why| why.contains("over")).unwrap_or_else(|| "fails".to_owned());
    };
    let steps = entry.iterations.map_or_else(String::new, |steps| format!("{steps}, "));
    let megabytes = entry.megabytes.unwrap_or_default();
    let text = format!("{} ms ({steps}{}, {megabytes:.0} MB)", general(1e3 * seconds, 3), scientific(gap, 0));
    if gap < FOUND { text } else { format!("*{text}*") }
}

/// The table and a summary of it; `poses` gives the number of poses of a graph.
pub(super) fn table(
    found: &Graphs,
    graphs: &[(String, f64)],
    poses: &dyn Fn(&str) -> anyhow::Result<usize>,
) -> anyhow::Result<String> {
    let head = [&["graph", "poses", "start"], &SOLVERS[..], &["fastest peer / posecut"]].concat();
    let (mut rows, mut factors) = (Vec::new(), Vec::new());
    for (name, by_start) in &found.0 {
        let (best, poses) = (best(graphs, name)?, poses(name)?);
        for (start, solvers) in &by_start.0 {
            let mut row = vec![name.clone(), poses.to_string(), start.clone()];
            let mut fastest = f64::INFINITY;
            for solver in SOLVERS {
                let entry = solvers.of(solver)?;
                row.push(cell(entry, best));
                if solver != SOLVERS[0] && entry.gap(best) < FOUND {
                    fastest = entry.seconds.unwrap_or(f64::INFINITY).min(fastest);
                }
            }
            let factor = fastest / solvers.of(SOLVERS[0])?.seconds.unwrap_or(f64::NAN);
            row.push(if fastest.is_finite() { format!("{factor:.2}") } else { "none gets there".to_owned() });
            rows.push(row);
            if poses >= 1000 && start != "chordal" {
                factors.push((factor, format!("{name} from {start}")));
            }
        }
    }
    let table = markdown::table(&markdown::cells(&head), head.len(), &rows).join("\n");
    Ok(format!("{table}\n\n{}", together(factors)))
}

fn together(mut factors: Vec<(f64, String)>) -> String {
    factors.sort_by(|one, other| one.0.total_cmp(&other.0).then_with(|| one.1.cmp(&other.1)));
    let met: Vec<f64> =
        factors.iter().map(|(factor, _)| *factor).filter(|factor| factor.is_finite()).collect();
    let count = |range: std::ops::Range<f64>| met.iter().filter(|factor| range.contains(factor)).count();
    let least: Vec<String> =
        factors.iter().take(3).map(|(factor, row)| format!("{row} {factor:.2}")).collect();
    format!(
        "Graphs of 1000 poses and more, from the file's poses and from odometry, are {} rows. In {} no peer gets there; in {} \
         posecut is at least twice as fast as the fastest peer that does, in {} faster by less, in {} slower. The lowest factors: \
         {}.",
        factors.len(),
        factors.len() - met.len(),
        count(2.0..f64::INFINITY),
        count(1.0..2.0),
        count(f64::NEG_INFINITY..1.0),
        least.join(", ")
    )
}

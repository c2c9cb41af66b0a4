//! How far from proved PCM's clique searches are on the map of regimes, for docs/results/pcm.md.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail};
use clap::Args;
use serde::Deserialize;
use serde_json::Value;
use xtask::sections::replace;
use xtask::workspace::{from_root, program, root, target};

use crate::Verdict;
use crate::machine::{Machine, today};
use crate::markdown::{cells, table};
use crate::process::{must, visibly};

/// Measure how far from proved PCM's cliques are on the map of regimes
///
/// Runs pipelines/cliques.toml over real and over simulated sessions, and regenerates the section `cliques` of docs/results/pcm.md.
/// Finished tasks do not run again.
#[derive(Args)]
pub(crate) struct Cliques {
    /// Directory of NCLT sessions, such as data/nclt
    nclt: PathBuf,
    /// Measure with seeds 1 to N
    #[arg(long, value_name = "N", default_value_t = 3)]
    seeds: u64,
}

const EXPERIMENT: &str = "pipelines/cliques.toml";

/// The gates, each with the method that has the map's limit and the one that has a larger limit.
const GATES: [(&str, [&str; 2]); 3] = [
    ("The correct gate", ["pcm", "longer"]),
    ("The root gate", ["pcm-root", "root-longer"]),
    ("Calibrated covariances", ["pcm-calibrated", "calibrated-longer"]),
];

/// A task of the plan. Only those that evaluate have labels: numbers or texts.
#[derive(Deserialize)]
struct Task {
    stage: String,
    labels: Option<Value>,
    /// The files that the method wrote, in order.
    #[serde(default)]
    chain: Vec<PathBuf>,
}

/// What a run of PCM reports of its search.
#[derive(Deserialize)]
struct Search {
    clique_size: u64,
    clique_upper_bound: u64,
    seconds_clique: f64,
}

/// The searches of one cell of the map.
#[derive(Default)]
struct Cell {
    runs: usize,
    proved: usize,
    /// The largest share by which a bound exceeds its clique.
    widest: f64,
    /// The longest search, seconds.
    longest: f64,
}

impl Cell {
    fn add(&mut self, search: &Search) {
        let open = search.clique_upper_bound - search.clique_size;
        self.runs += 1;
        self.proved += usize::from(open == 0);
        self.widest = self.widest.max(open as f64 / search.clique_size.max(1) as f64);
        self.longest = self.longest.max(search.seconds_clique);
    }

    fn text(&self) -> String {
        if self.proved == self.runs {
            return "all".to_owned();
        }
        format!("{} of {}, {:.1} %", self.proved, self.runs, 100.0 * self.widest)
    }
}

/// Cells by method, row (kind and share of incorrect edges) and covariance scale.
type Map = BTreeMap<(String, String, Scale), Cell>;

/// A covariance scale, in the order of its value.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Scale(u64, String);

impl Scale {
    fn of(text: &str) -> anyhow::Result<Self> {
        let value: f64 = text.parse().with_context(|| format!("covariance_scale {text}"))?;
        Ok(Self((value * 1e6) as u64, text.to_owned()))
    }
}

impl Cliques {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let mut map = Map::new();
        for sessions in [Some(from_root(&self.nclt)?), None] {
            self.sweep(sessions.as_deref(), &mut map)?;
        }
        if map.is_empty() {
            bail!(
                "no search ran: {} has no session of {EXPERIMENT}, or every run failed",
                self.nclt.display()
            );
        }
        let machine = Machine::here();
        let mut text = format!(
            "Measured {} on {} cores, {}. Made by `cargo xtask measure cliques`. A cell shows *all* where every search ended with a proof; \
             otherwise how many did, and the largest share by which a bound exceeds its clique.\n",
            today()?,
            machine.cores,
            machine.model
        );
        for (gate, methods) in GATES {
            for (method, limit) in methods.iter().zip(["a limit of 2000 nodes", "the longer limit"]) {
                text += &section(&map, gate, method, limit);
            }
        }
        print!("{text}");
        replace(&root().join("docs/results/pcm.md"), "cliques", &text)?;
        Ok(Verdict::Holds)
    }

    /// Runs the searches on real sessions, or on simulated ones, and reads the statistics of PCM.
    fn sweep(&self, nclt: Option<&Path>, map: &mut Map) -> anyhow::Result<()> {
        let folder = target().join("cliques");
        fs::create_dir_all(&folder)?;
        let call = |mode: &str| {
            let mut command = Command::new(program("experiment"));
            command.current_dir(root()).arg(mode).arg("--simulated").arg(folder.join("sessions"));
            match nclt {
                Some(nclt) => command.arg("--results").arg(folder.join("real")).arg("--nclt").arg(nclt),
                None => command.arg("--results").arg(folder.join("simulated")),
            };
            command
        };
        let mut planner = call("plan");
        planner.args([EXPERIMENT, "--seeds", &self.seeds.to_string()]);
        let plan = String::from_utf8(must(&mut planner)?)?;
        let tasks: Vec<(&str, Task)> = plan
            .lines()
            .map(|line| Ok((line, serde_json::from_str(line)?)))
            .collect::<serde_json::Result<_>>()?;
        // Nothing after PCM is of interest here.
        let needed = |task: &Task| !["oracle", "optimize", "evaluate"].contains(&task.stage.as_str());
        let lines: Vec<&str> = tasks.iter().filter(|(_, task)| needed(task)).map(|(line, _)| *line).collect();
        let list = folder.join("tasks.jsonl");
        fs::write(&list, lines.join("\n") + "\n")?;
        // The runner names each failed run, such as a session without room for a corridor.
        if visibly(call("run").arg(&list)).is_err() {
            eprintln!("some runs failed: the table omits them");
        }
        for (_, task) in tasks {
            let (Some(labels), Some(written)) = (task.labels, task.chain.last()) else { continue };
            // A label is a text or a number.
            let label =
                |name: &str| labels[name].as_str().map_or_else(|| labels[name].to_string(), str::to_owned);
            let method = label("method");
            if !GATES.iter().any(|(_, methods)| methods.contains(&method.as_str())) {
                continue;
            }
            let Ok(statistics) = fs::read_to_string(root().join(written.with_extension("stats.json"))) else {
                continue;
            };
            let share: f64 = label("incorrect_rate").parse()?;
            let row = format!("{} | {:2.0} %", label("incorrect_kind"), 100.0 * share);
            let scale = Scale::of(&label("covariance_scale"))?;
            let cell = map.entry((method, row, scale)).or_default();
            cell.add(&serde_json::from_str(&statistics)?);
        }
        Ok(())
    }
}

/// The table of one method, and its longest search.
fn section(map: &Map, gate: &str, method: &str, limit: &str) -> String {
    let of_method = || map.iter().filter(|((own, ..), _)| own == method);
    let mut rows: Vec<&String> = of_method().map(|((_, row, _), _)| row).collect();
    let mut scales: Vec<&Scale> = of_method().map(|((.., scale), _)| scale).collect();
    rows.sort_by_key(|row| (!row.starts_with("uniform"), (*row).clone()));
    rows.dedup();
    scales.sort();
    scales.dedup();
    let body: Vec<Vec<String>> = rows
        .into_iter()
        .map(|row| {
            let cell = |scale: &&Scale| {
                let found = map.get(&(method.to_owned(), row.clone(), (*scale).clone()));
                found.map_or_else(|| "–".to_owned(), Cell::text)
            };
            row.split(" | ").map(|word| word.trim().to_owned()).chain(scales.iter().map(cell)).collect()
        })
        .collect();
    let mut head = cells(&["kind", "share"]);
    head.extend(scales.iter().map(|scale| format!("× {}", scale.1)));
    let longest = of_method().map(|(_, cell)| cell.longest).fold(0.0, f64::max);
    let (runs, proved) =
        of_method().fold((0, 0), |(runs, proved), (_, cell)| (runs + cell.runs, proved + cell.proved));
    format!(
        "\n{gate}, {limit}: {proved} of {runs} searches proved, the longest took {longest:.1} s.\n\n{}\n",
        table(&head, 2, &body).join("\n")
    )
}

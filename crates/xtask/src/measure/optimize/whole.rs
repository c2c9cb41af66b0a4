//! Measures the whole process on benchmark graphs.

use anyhow::Context as _;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use super::pinned::{Pinned, converted, nodes, started, work};
use super::{Named, Results, best, named};
use crate::markdown;
use crate::numbers::{general, scientific};

#[derive(Deserialize)]
#[serde(transparent)]
pub(super) struct Graphs(#[serde(deserialize_with = "named")] pub(super) Named<Graph>);

#[derive(Deserialize)]
pub(super) struct Graph {
    poses: u64,
    pub(super) plain: Run,
    odometry: Run,
    certify: Run,
    marginals: Run,
}

/// The measurement of one process, with its `--stats`.
#[derive(Deserialize)]
pub(super) struct Run {
    seconds: f64,
    megabytes: f64,
    certificate: Option<String>,
    cost: f64,
    /// Operations of one factorisation; older measurements lack them.
    pub(super) flops: Option<f64>,
    iterations: u64,
    pub(super) factorizations: u64,
    termination: String,
    start: String,
    /// Other fields, such as the seconds of the phases.
    #[serde(flatten)]
    others: Map<String, Value>,
}

impl Run {
    /// Seconds of a phase.
    pub(super) fn phase(&self, name: &str) -> f64 {
        self.others.get(&format!("{name}_seconds")).and_then(Value::as_f64).unwrap_or(f64::NAN)
    }
}

pub(super) fn measure(name: &str, results: &mut Results) -> anyhow::Result<()> {
    let graph = converted(name)?;
    let odometry = work().join(format!("{name}.odometry.jsonl"));
    started(&graph, "spanning-tree", &odometry)?;
    let (stats, output) = (work().join("stats.json"), work().join("out.jsonl"));
    let mut entry = Map::new();
    entry.insert("poses".to_owned(), nodes(&graph)?.into());
    for (word, start, options) in [
        ("plain", &graph, &[][..]),
        ("odometry", &odometry, &[]),
        ("certify", &graph, &["--certify"]),
        ("marginals", &graph, &["--marginals", "all"]),
    ] {
        let mut best: Option<crate::process::Measured> = None;
        for _ in 0..3 {
            let optimize =
                Pinned::posecut("optimize").words(options).path(start).words(&["-o"]).path(&output);
            let run = optimize.words(&["--stats"]).path(&stats).must()?;
            best = Some(match best.take() {
                Some(before) if before.wall <= run.wall => before,
                _ => run,
            });
        }
        let best = best.context("no run")?;
        let said: Map<String, Value> = serde_json::from_str(&std::fs::read_to_string(&stats)?)?;
        let of = |key: &str| said.get(key).cloned().unwrap_or(Value::Null);
        let mut run = json!({
            "seconds": best.wall,
            "megabytes": best.peak as f64 / f64::from(1 << 20),
            "certificate": of("certificate"),
            "cost": of("chi_square"),
            "blocks": of("factor_blocks"),
            "flops": of("factor_flops"),
        });
        let phases = said.keys().filter(|key| key.ends_with("_seconds"));
        for key in phases.map(String::as_str).chain(["iterations", "factorizations", "termination", "start"])
        {
            run[key] = of(key);
        }
        entry.insert(word.to_owned(), run);
    }
    println!("{name} {}", Value::from(entry.clone()));
    results.keep(&["process", name], entry)
}

pub(super) fn table(found: &Graphs, graphs: &[(String, f64)]) -> anyhow::Result<String> {
    let head = [
        "graph",
        "poses",
        "cost",
        "best known",
        "gap",
        "from odometry: gap",
        "start",
        "steps (factorisations)",
        "ended by",
        "whole process, s (MB)",
        "with --certify, s",
        "verdict",
        "with --marginals all, s",
    ];
    let row = |(name, graph): &(String, Graph)| {
        let (plain, best) = (&graph.plain, best(graphs, name)?);
        let gap = |run: &Run| scientific((run.cost - best) / best, 0);
        anyhow::Ok(vec![
            name.clone(),
            graph.poses.to_string(),
            general(plain.cost, 12),
            general(best, 12),
            gap(plain),
            gap(&graph.odometry),
            plain.start.clone(),
            format!("{} ({})", plain.iterations, plain.factorizations),
            plain.termination.clone(),
            format!("{:.3} ({:.0})", plain.seconds, plain.megabytes),
            format!("{:.3}", graph.certify.seconds),
            graph.certify.certificate.clone().unwrap_or_else(|| "None".to_owned()),
            format!("{:.3}", graph.marginals.seconds),
        ])
    };
    let rows: Vec<Vec<String>> = found.0.iter().map(row).collect::<anyhow::Result<_>>()?;
    Ok(markdown::table(&markdown::cells(&head), head.len(), &rows).join("\n"))
}

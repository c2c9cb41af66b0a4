//! Measures robust kernels and GNC on graphs with false closures: distance from the solution without these closures.

use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use serde::Deserialize;
use serde_json::{Map, Value};
use xtask::workspace::shared_data;

use super::pinned::{Pinned, work};
use super::{Named, Results, named};
use crate::markdown;

const MODES: [(&str, &[&str]); 7] = [
    ("plain", &[]),
    ("Huber", &["--kernel-landmark", "huber"]),
    ("Cauchy", &["--kernel-landmark", "cauchy"]),
    ("Geman-McClure", &["--kernel-landmark", "geman-mcclure"]),
    ("DCS", &["--kernel-landmark", "dcs"]),
    ("GNC", &["--gnc"]),
    ("GNC (Geman-McClure)", &["--gnc=geman-mcclure"]),
];

#[derive(Deserialize)]
#[serde(transparent)]
pub(super) struct Graphs(#[serde(deserialize_with = "named")] Named<Map<String, Value>>);

pub(super) fn measure(only: &[String], results: &mut Results) -> anyhow::Result<()> {
    let pattern = shared_data()?.join("false_closures/corrupted/*.g2o");
    for source in glob::glob(&pattern.to_string_lossy())? {
        let source = source?;
        let name = source.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !only.is_empty() && !only.contains(&name) {
            continue;
        }
        let (graph, clean) = labelled(&source)?;
        let reference =
            positions(&clean, &[])?.with_context(|| format!("{name} without false closures: fails"))?;
        let mut row = Map::new();
        for (mode, options) in MODES {
            let rmse = positions(&graph, options)?.map(|found| distance(&found, &reference));
            row.insert(mode.to_owned(), rmse.into());
        }
        println!("{name} {}", Value::from(row.clone()));
        results.keep(&["robust", &name], row)?;
    }
    Ok(())
}

/// The graph with its false closures as landmark edges, and the same graph with them rejected.
fn labelled(source: &Path) -> anyhow::Result<(PathBuf, PathBuf)> {
    let (graph, clean) = (work().join("corrupted.jsonl"), work().join("clean.jsonl"));
    Pinned::posecut("convert").path(source).words(&["-o"]).path(&graph).must()?;
    let text = std::fs::read_to_string(&graph)?;
    let mut records: Vec<Value> = text.lines().map(serde_json::from_str).collect::<Result<_, _>>()?;
    let labels = source.with_extension("labels.csv");
    let place = || format!("{}: does not fit {}", labels.display(), source.display());
    let text = std::fs::read_to_string(&labels).with_context(|| labels.display().to_string())?;
    let labels: Vec<Vec<&str>> = text.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let is_edge = |record: &&mut Value| record["kind"] == "odometry" || record["kind"] == "landmark";
    let count = records.iter_mut().filter(is_edge).count();
    if count != labels.len() {
        bail!("{}: {} labels for {count} edges", place(), labels.len());
    }
    for (edge, label) in records.iter_mut().filter(is_edge).zip(&labels) {
        let [from, to, kind, ..] = label.as_slice() else { bail!("{}: {label:?}", place()) };
        let named = |end: &str, label: &str| label.parse().is_ok_and(|id: u64| edge[end] == id);
        if !named("from", from) || !named("to", to) {
            bail!("{}: the edge from {} to {} is labelled {from} to {to}", place(), edge["from"], edge["to"]);
        }
        edge["kind"] = if *kind == "odom" { "odometry" } else { "landmark" }.into();
    }
    write(&graph, &records)?;
    for (edge, label) in records.iter_mut().filter(is_edge).zip(&labels) {
        if label.get(3) != Some(&"1") {
            edge["rejected_by"] = "truth".into();
        }
    }
    write(&clean, &records)?;
    Ok((graph, clean))
}

fn write(path: &Path, records: &[Value]) -> anyhow::Result<()> {
    let mut file = BufWriter::new(std::fs::File::create(path)?);
    records.iter().try_for_each(|record| writeln!(file, "{record}"))?;
    Ok(file.flush()?)
}

/// The positions of all nodes; `None` if the optimiser fails.
fn positions(graph: &Path, options: &[&str]) -> anyhow::Result<Option<Vec<[f64; 2]>>> {
    let output = work().join("robust.jsonl");
    if Pinned::posecut("optimize").words(options).path(graph).words(&["-o"]).path(&output).run()?.is_err() {
        return Ok(None);
    }
    let mut found = Vec::new();
    for line in std::fs::read_to_string(&output)?.lines() {
        let record: Value = serde_json::from_str(line)?;
        if record["kind"] == "node" {
            let coordinate = |axis: usize| record["pose"][axis].as_f64().context("a node has no pose");
            found.push([coordinate(0)?, coordinate(1)?]);
        }
    }
    Ok(Some(found))
}

/// Root mean square distance, metres.
fn distance(found: &[[f64; 2]], reference: &[[f64; 2]]) -> f64 {
    let squares = found.iter().zip(reference).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]).powi(2));
    (squares.sum::<f64>() / reference.len() as f64).sqrt()
}

pub(super) fn table(found: &Graphs) -> String {
    let names = MODES.map(|(mode, _)| mode);
    let head = [&["graph"], &names[..]].concat();
    let row = |(name, row): &(String, Map<String, Value>)| {
        let cell = |mode: &str| match row.get(mode).and_then(Value::as_f64) {
            Some(metres) => format!("{metres:.3}"),
            None => "fails".to_owned(),
        };
        [name.clone()].into_iter().chain(names.map(cell)).collect()
    };
    let rows: Vec<Vec<String>> = found.0.iter().map(row).collect();
    markdown::table(&markdown::cells(&head), head.len(), &rows).join("\n")
}

//! Fingerprints of outputs: the values that are compared with expectations.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context as _, bail};
use posecut_graph::{Dimension, EdgeKind, PoseGraph};
use serde_json::Value;

/// Counts and choices that must agree exactly, and numbers that must agree closely.
///
/// All values are computed from the output itself, not from a stage's statistics, so they work for other people's stages too.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fingerprint {
    /// Numbers of things, and lists of ids such as `7 9-12`.
    pub exact: BTreeMap<String, toml::Value>,
    /// Means of measurements and poses, RMSE: metres and radians.
    pub close: BTreeMap<String, f64>,
}

impl Fingerprint {
    /// Reads a pose graph (`.jsonl`), a result (`.result.json`) or a folder of tables. O(size).
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let place = path.display();
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        if path.is_dir() {
            return folder(path);
        }
        let bytes = std::fs::read(path).with_context(|| format!("{place}: cannot be read"))?;
        if name.ends_with(".result.json") {
            return result(&bytes).with_context(|| format!("{place}: is not a result of posecut-evaluate"));
        }
        if path.extension().is_some_and(|extension| extension == "jsonl") {
            return Ok(graph(&PoseGraph::read(&place.to_string(), bytes.as_slice())?));
        }
        bail!("{place}: is neither a pose graph (.jsonl) nor a result (.result.json)")
    }

    fn count(&mut self, name: &str, number: usize) {
        self.exact.insert(name.to_owned(), toml::Value::Integer(i64::try_from(number).unwrap_or(i64::MAX)));
    }

    fn mean<'a>(&mut self, family: &str, components: &[&str], rows: impl Iterator<Item = &'a [f64]>) {
        let mut sums = vec![0.0; components.len()];
        let mut number = 0;
        for row in rows {
            number += 1;
            for (sum, value) in sums.iter_mut().zip(row) {
                *sum += value;
            }
        }
        for (component, sum) in components.iter().zip(sums).filter(|_| number > 0) {
            self.close.insert(format!("{family}_{component}"), sum / f64::from(number));
        }
    }
}

fn graph(graph: &PoseGraph) -> Fingerprint {
    let mut found = Fingerprint::default();
    let components: &[&str] = match graph.header.dimension {
        Dimension::Two => &["x", "y", "theta"],
        Dimension::Three => &["x", "y", "z", "qx", "qy", "qz", "qw"],
    };
    let landmarks = || graph.edges_of(EdgeKind::Landmark);
    found.count("nodes", graph.nodes.len());
    found.count("odometry_edges", graph.edges_of(EdgeKind::Odometry).count());
    found.count("landmark_edges", landmarks().count());
    let rejected: Vec<u64> = landmarks().filter(|edge| !edge.in_use()).map(|edge| edge.id).collect();
    found.count("rejected_edges", rejected.len());
    found.exact.insert("rejected".to_owned(), toml::Value::String(ranges(&rejected)));
    let labels: BTreeSet<u64> = graph.nodes.iter().filter_map(|node| node.landmark).collect();
    found.count("landmarks", labels.len());
    found.mean("pose", components, graph.nodes.iter().filter_map(|node| node.pose.as_deref()));
    let odometry = || graph.edges_of(EdgeKind::Odometry);
    found.mean("odometry", components, odometry().filter_map(|edge| edge.measurement.as_deref()));
    found.mean("landmark", components, landmarks().filter_map(|edge| edge.measurement.as_deref()));
    // The first and the last diagonal term: the information of a translation and of a rotation.
    let weights: Vec<[f64; 2]> = odometry()
        .filter_map(|edge| {
            let information = graph.information(edge)?;
            Some([*information.first()?, *information.last()?])
        })
        .collect();
    found.mean("information", &["translation", "rotation"], weights.iter().map(|row| &row[..]));
    found
}

fn result(bytes: &[u8]) -> anyhow::Result<Fingerprint> {
    let value: Value = serde_json::from_slice(bytes)?;
    let mut found = Fingerprint::default();
    for name in ["components", "poses", "poses_unmatched"] {
        found.count(name, usize::try_from(value[name].as_u64().context(name)?)?);
    }
    for name in ["true_positive", "false_positive", "false_negative", "true_negative"] {
        if let Some(number) = value["edges"][name].as_u64() {
            found.count(name, usize::try_from(number)?);
        }
    }
    found.close.insert("rmse".to_owned(), value["rmse"].as_f64().context("rmse")?);
    Ok(found)
}

/// The fingerprint of a simulated session: number of rows and mean of each table.
fn folder(path: &Path) -> anyhow::Result<Fingerprint> {
    let mut found = Fingerprint::default();
    for entry in std::fs::read_dir(path).with_context(|| format!("{}: cannot be listed", path.display()))? {
        let file = entry?.path();
        let Some(name) = file.file_stem().map(|name| name.to_string_lossy().into_owned()) else { continue };
        let text =
            std::fs::read_to_string(&file).with_context(|| format!("{}: cannot be read", file.display()))?;
        found.count(&format!("{name}_rows"), text.lines().count());
        // Leave out the time column: it is so large that it would hide all other numbers.
        let numbers = text.lines().flat_map(|line| line.split(',').skip(1));
        let numbers: Vec<f64> = numbers
            .filter_map(|number| number.trim().parse().ok())
            .filter(|number: &f64| number.is_finite())
            .collect();
        found.close.insert(format!("{name}_mean"), numbers.iter().sum::<f64>() / numbers.len().max(1) as f64);
    }
    Ok(found)
}

/// Writes ids as `7 9-12`: in order, with runs shortened.
fn ranges(ids: &[u64]) -> String {
    let mut parts: Vec<String> = Vec::new();
    let mut rest = ids;
    while let [first, ..] = rest {
        let run = rest.iter().zip(*first..).take_while(|(id, next)| **id == *next).count();
        let last = rest[run - 1];
        parts.push(if last == *first { first.to_string() } else { format!("{first}-{last}") });
        rest = &rest[run..];
    }
    parts.join(" ")
}

/// Reads the ids of a list that [`ranges`] wrote.
pub(crate) fn ids(ranges: &str) -> BTreeSet<u64> {
    ranges
        .split_whitespace()
        .filter_map(|part| {
            let (first, last) = part.split_once('-').unwrap_or((part, part));
            Some(first.parse().ok()?..=last.parse().ok()?)
        })
        .flatten()
        .collect()
}

/// Writes ids as such a list.
pub(crate) fn listed(ids: impl Iterator<Item = u64>) -> String {
    ranges(&ids.collect::<Vec<_>>())
}

//! Results of evaluations, read back.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use serde::Deserialize;
use serde_json::Value;

/// One evaluation, as far as tables need it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RunResult {
    format: String,
    version: u64,
    labels: BTreeMap<String, Value>,
    /// Metres.
    pub rmse: f64,
    /// Parts of the graph that no edge in use joins.
    pub components: usize,
    /// Precision and recall of landmark edges, where their truth is known.
    pub edges: Option<Edges>,
}

/// Landmark edges in use and rejected, by their truth.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Edges {
    /// Correct and in use.
    pub true_positive: usize,
    /// Incorrect and in use.
    pub false_positive: usize,
    /// Correct and rejected.
    pub false_negative: usize,
    /// Incorrect and rejected.
    pub true_negative: usize,
}

impl RunResult {
    /// A label as text; what it is not labelled with is empty.
    pub fn label(&self, name: &str) -> String {
        match self.labels.get(name) {
            None => String::new(),
            Some(Value::String(text)) => text.clone(),
            Some(other) => other.to_string(),
        }
    }
}

/// Reads results: files as named, directories searched for `*.result.json`. Sorted by path, so that tables do
/// not depend on the order of directories.
pub fn read_all(paths: &[PathBuf]) -> anyhow::Result<Vec<RunResult>> {
    let mut files = Vec::new();
    for path in paths {
        if path.is_dir() {
            collect(path, &mut files)?;
        } else {
            files.push(path.clone());
        }
    }
    files.sort();
    files.dedup();
    files.iter().map(|file| read(file)).collect()
}

fn collect(directory: &Path, files: &mut Vec<PathBuf>) -> anyhow::Result<()> {
    let place = || format!("{}: cannot be listed", directory.display());
    for entry in std::fs::read_dir(directory).with_context(place)? {
        let path = entry.with_context(place)?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.to_string_lossy().ends_with(".result.json") {
            files.push(path);
        }
    }
    Ok(())
}

fn read(path: &Path) -> anyhow::Result<RunResult> {
    let place = path.display();
    let bytes = std::fs::read(path).with_context(|| format!("{place}: cannot be read"))?;
    let result: RunResult = serde_json::from_slice(&bytes)
        .with_context(|| format!("{place}: is no result; write results with posecut-evaluate"))?;
    if result.format != "posecut-result" || result.version != 1 {
        bail!(
            "{place}: is \"{}\" version {}, and a posecut-result version 1 was expected; evaluate again",
            result.format,
            result.version
        );
    }
    if !result.rmse.is_finite() {
        bail!("{place}: its RMSE is no finite number; evaluate again");
    }
    Ok(result)
}

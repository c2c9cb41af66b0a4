//! Reads results of evaluations.

use std::collections::BTreeMap;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use posecut_graph::StageDoubt;
use posecut_stage::info;
use serde::Deserialize;
use serde_json::Value;

/// One evaluation, with the fields that tables need.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct RunResult {
    format: String,
    version: u64,
    labels: BTreeMap<String, Value>,
    /// Metres.
    pub rmse: f64,
    /// Components of the graph of edges in use.
    pub components: usize,
    /// Precision and recall of landmark edges, if their truth is known.
    pub edges: Option<Edges>,
    /// The doubts of the stages, oldest first; empty in files of older programs.
    #[serde(default)]
    pub doubts: Vec<StageDoubt>,
    /// The history of the estimate: one object a stage.
    #[serde(default)]
    pub provenance: Vec<Value>,
    /// The motions that the alignment was allowed, named as in results.
    #[serde(default)]
    pub alignment: Option<AlignmentUsed>,
}

/// How the poses were aligned before the error was measured.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub struct AlignmentUsed {
    /// `none`, `SE(2)`, `SE(3)` or `Sim(3)`.
    pub freedom: String,
    /// `joint` or `per-session`.
    pub scope: String,
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

impl Edges {
    /// Share of correct edges among those in use; absent if none is in use.
    pub fn precision(&self) -> Option<f64> {
        share(self.true_positive, self.false_positive)
    }

    /// Share of correct edges that are in use; absent if none is correct.
    pub fn recall(&self) -> Option<f64> {
        share(self.true_positive, self.false_negative)
    }
}

fn share(part: usize, rest: usize) -> Option<f64> {
    (part + rest > 0).then(|| part as f64 / (part + rest) as f64)
}

impl RunResult {
    /// A label as text; empty if the result does not have it.
    pub fn label(&self, name: &str) -> String {
        match self.labels.get(name) {
            None => String::new(),
            Some(Value::String(text)) => text.clone(),
            Some(other) => other.to_string(),
        }
    }
}

/// A result with the file it was read from.
#[derive(Clone, Debug, PartialEq)]
pub struct Located {
    /// The file.
    pub path: PathBuf,
    /// Its content.
    pub result: RunResult,
    /// SHA-256 of the file's content, decompressed.
    pub sha256: String,
}

/// Reads results from the given files, and from every `*.result.json` in the given directories. They are sorted by
/// path, so that tables do not depend on the order of directories.
pub fn read_all(paths: &[PathBuf]) -> anyhow::Result<Vec<RunResult>> {
    Ok(read_located(paths)?.into_iter().map(|located| located.result).collect())
}

/// Reads results like [`read_all`], with the file of each. A file whose name ends in `.jsonl` or `.jsonl.gz` has one
/// result a line. A file in a directory that has errors of relations alone, as `make map` leaves it, belongs to no table: it is skipped.
pub fn read_located(paths: &[PathBuf]) -> anyhow::Result<Vec<Located>> {
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
    let mut results = Vec::new();
    for file in files {
        read(&file, !paths.contains(&file), &mut results)?;
    }
    Ok(results)
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

fn read(path: &Path, found: bool, results: &mut Vec<Located>) -> anyhow::Result<()> {
    let place = path.display().to_string();
    let unreadable = || format!("{place}: cannot be read");
    let mut input = posecut_stage::open_file(path)?;
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes).with_context(unreadable)?;
    let sha256 = input.finish().with_context(unreadable)?;
    let name = path.to_string_lossy();
    if !(name.ends_with(".jsonl") || name.ends_with(".jsonl.gz")) {
        let result = match parse(&place, &bytes) {
            Err(_) if found && has_relations_alone(&bytes) => {
                info!("{place}: skipped, because it has errors of relations but no RMSE");
                return Ok(());
            }
            parsed => parsed?,
        };
        results.push(Located { path: path.to_owned(), result, sha256 });
        return Ok(());
    }
    for (index, line) in bytes.split(|&byte| byte == b'\n').enumerate() {
        if line.iter().all(u8::is_ascii_whitespace) {
            continue;
        }
        let result = parse(&format!("{place}, line {}", index + 1), line)?;
        results.push(Located { path: path.to_owned(), result, sha256: sha256.clone() });
    }
    Ok(())
}

fn has_relations_alone(bytes: &[u8]) -> bool {
    let result: Option<Value> = serde_json::from_slice(bytes).ok();
    result.is_some_and(|result| result["rmse"].is_null() && result["relations"].is_object())
}

/// Refuses what another program or another version wrote.
pub(crate) fn check_format(place: &str, format: &str, version: u64) -> anyhow::Result<()> {
    if format != "posecut-result" || version != 1 {
        bail!(
            "{place}: is \"{format}\" version {version}, but must be posecut-result version 1; evaluate again"
        );
    }
    Ok(())
}

fn parse(place: &str, bytes: &[u8]) -> anyhow::Result<RunResult> {
    let result: RunResult = serde_json::from_slice(bytes)
        .with_context(|| format!("{place}: is not a result; write results with posecut-evaluate"))?;
    check_format(place, &result.format, result.version)?;
    if !result.rmse.is_finite() {
        bail!("{place}: its RMSE is not a finite number; evaluate again");
    }
    Ok(result)
}

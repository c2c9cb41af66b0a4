//! Collected results, by point of the grid.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context as _, bail};
use serde::Deserialize;
use serde_json::Value;
use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// One line of a collected file.
#[derive(Clone, Debug, Deserialize)]
pub struct Record {
    labels: BTreeMap<String, Value>,
    /// Metres.
    pub rmse: f64,
    /// Landmark edges by truth and use.
    pub edges: Option<Edges>,
}

/// Landmark edges in use (positive) and rejected, by their truth.
#[derive(Clone, Copy, Debug, Deserialize)]
pub struct Edges {
    /// Correct, in use.
    pub true_positive: u32,
    /// Incorrect, in use.
    pub false_positive: u32,
    /// Correct, rejected.
    pub false_negative: u32,
    /// Incorrect, rejected.
    pub true_negative: u32,
}

impl Record {
    /// A label as text.
    pub fn label(&self, name: &str) -> String {
        match self.labels.get(name) {
            None => String::new(),
            Some(Value::String(text)) => text.clone(),
            Some(other) => other.to_string(),
        }
    }
}

/// A mean and half the width of its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The mean.
    pub mean: f64,
    /// Half the width at 95 %; absent for fewer than two values.
    pub half_width: Option<f64>,
    /// How many values.
    pub count: usize,
}

impl Interval {
    /// The mean of values with its 95 % interval by Student's t distribution: mean ± t s / sqrt(n). `None` without
    /// values.
    pub fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() {
            return None;
        }
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let half_width =
            StudentsT::new(0.0, 1.0, count - 1.0).ok().filter(|_| values.len() > 1).map(|student| {
                let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
                student.inverse_cdf(0.975) * (squares / (count - 1.0) / count).sqrt()
            });
        Some(Self { mean, half_width, count: values.len() })
    }
}

/// All results, found by session, point and method.
#[derive(Debug, Default)]
pub struct Samples {
    runs: BTreeMap<Place, BTreeMap<String, Record>>,
}

/// Session (with its pipeline), kind, rate, scale, method.
type Place = (String, String, String, String, String);

impl Samples {
    /// Reads collected files.
    pub fn read(paths: &[impl AsRef<Path>]) -> anyhow::Result<Self> {
        let mut samples = Self::default();
        for path in paths {
            let place = path.as_ref().display();
            let text = std::fs::read_to_string(path)
                .with_context(|| format!("{place}: cannot be read; collect first"))?;
            for (number, line) in text.lines().enumerate() {
                let record: Record = serde_json::from_str(line)
                    .with_context(|| format!("{place}, line {}: is no result", number + 1))?;
                let session = if record.label("pipeline").ends_with("-simulated") {
                    format!("{} simulated", record.label("session"))
                } else {
                    record.label("session")
                };
                let [kind, rate, scale] =
                    ["incorrect_kind", "incorrect_rate", "covariance_scale"].map(|name| record.label(name));
                if kind.is_empty() || rate.is_empty() || scale.is_empty() {
                    bail!(
                        "{place}, line {}: has no label incorrect_kind, incorrect_rate or covariance_scale; sweep pipelines/regimes.toml",
                        number + 1
                    );
                }
                let key = (session, kind, rate, scale, record.label("method"));
                samples.runs.entry(key).or_default().insert(record.label("seed"), record);
            }
        }
        if samples.runs.is_empty() {
            bail!("there are no results; run `make regimes`");
        }
        Ok(samples)
    }

    /// The results of one method at one point, by seed.
    pub fn at(
        &self,
        session: &str,
        kind: &str,
        rate: &str,
        scale: &str,
        method: &str,
    ) -> Option<&BTreeMap<String, Record>> {
        let text = str::to_owned;
        self.runs.get(&(text(session), text(kind), text(rate), text(scale), text(method)))
    }

    /// Session names.
    pub fn sessions(&self) -> BTreeSet<&str> {
        self.runs.keys().map(|key| key.0.as_str()).collect()
    }

    /// Kinds of incorrect edges.
    pub fn kinds(&self) -> BTreeSet<&str> {
        self.runs.keys().map(|key| key.1.as_str()).collect()
    }

    /// Shares of incorrect edges of a kind, ascending.
    pub fn rates(&self, kind: &str) -> Vec<&str> {
        ascending(self.runs.keys().filter(|key| key.1 == kind).map(|key| key.2.as_str()))
    }

    /// Covariance scales of a kind, ascending.
    pub fn scales(&self, kind: &str) -> Vec<&str> {
        ascending(self.runs.keys().filter(|key| key.1 == kind).map(|key| key.3.as_str()))
    }

    /// The numbers of seeds of all points, smallest and largest.
    pub fn seeds(&self) -> (usize, usize) {
        let counts = || self.runs.values().map(BTreeMap::len);
        (counts().min().unwrap_or(0), counts().max().unwrap_or(0))
    }
}

fn ascending<'a>(names: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut names: Vec<&str> = names.collect::<BTreeSet<_>>().into_iter().collect();
    let number = |name: &&str| name.parse::<f64>().unwrap_or(f64::INFINITY);
    names.sort_by(|first, second| number(first).total_cmp(&number(second)));
    names
}

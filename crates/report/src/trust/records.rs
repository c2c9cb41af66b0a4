//! Results and CPU times of runs, one JSON object a line. Reading is strict, because a result that is left out or
//! counted twice would change the comparison of methods unnoticed.

use std::collections::BTreeMap;
use std::fmt;
use std::path::Path;

use anyhow::{Context as _, bail};
use posecut_graph::{InputDigest, StageDoubt};
use posecut_stage::counted;
use serde_json::{Map, Value};

/// Which half of its family a run belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, clap::ValueEnum)]
pub enum Half {
    /// The runs on which constants are chosen
    Tuning,
    /// The runs on which no constant is chosen
    Test,
}

impl fmt::Display for Half {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str(match self {
            Self::Tuning => "tuning",
            Self::Test => "test",
        })
    }
}

/// Labels that do not identify a run but group it. All other labels except the method identify it.
const GROUPING: [&str; 3] = ["family", "half", "cluster"];

/// The key of a run: names and values of all labels except the method and those that group runs.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RunKey(BTreeMap<String, String>);

impl RunKey {
    /// The experiment that the run belongs to.
    pub fn pipeline(&self) -> &str {
        self.0.get("pipeline").map_or("", String::as_str)
    }

    /// The session, then the values of all other labels except the experiment, in the order of their names.
    pub fn short(&self) -> String {
        let session = self.0.get("session").map_or("", String::as_str);
        let others = self.0.iter().filter(|(name, _)| !["pipeline", "session"].contains(&name.as_str()));
        others.fold(session.to_owned(), |text, (name, value)| format!("{text}, {name} {value}"))
    }
}

impl fmt::Display for RunKey {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        for (index, (name, value)) in self.0.iter().enumerate() {
            write!(formatter, "{}{name} {value}", if index == 0 { "" } else { ", " })?;
        }
        Ok(())
    }
}

/// The outcome of a method on a run that it finished.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// RMSE against the optimum of the correct edges, metres.
    pub rmse: f64,
    /// Components of the graph of edges in use.
    pub components: usize,
    /// Incorrect edges in use.
    pub false_kept: usize,
    /// Correct edges in use.
    pub correct_kept: usize,
    /// Correct edges rejected.
    pub correct_lost: usize,
    /// Distances from the ground truth, where the graph has one.
    pub truth: Option<TruthDistance>,
}

/// How far a map and the optimum of the correct edges are from the ground truth, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TruthDistance {
    /// RMSE of the method's map.
    pub own: f64,
    /// RMSE of the optimum of the correct edges.
    pub reference: f64,
    /// RMSE of the method's map with an alignment for each part that its edges in use connect; absent in results of older programs.
    pub joined: Option<f64>,
}

/// Bins of `verify_probability`, each 0.1 wide.
pub const BINS: usize = 10;

/// Landmark edges by bins of their probability.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bins {
    /// Edges of each bin.
    pub edges: [u64; BINS],
    /// The sum of their probabilities.
    pub probability: [f64; BINS],
    /// Number of correct edges among them.
    pub correct: [u64; BINS],
}

/// One line of results.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// File and line, for messages.
    pub place: String,
    /// The run.
    pub run: RunKey,
    /// The method.
    pub method: String,
    /// The family of graphs.
    pub family: String,
    /// The half of the family.
    pub half: Half,
    /// Runs of one cluster are not independent of each other.
    pub cluster: String,
    /// The outcome, or the reason why there is none.
    pub outcome: Result<Outcome, String>,
    /// Landmark edges by their probability; `None` if they have none or the run failed.
    pub probabilities: Option<Bins>,
    /// Doubts of the run's stages.
    pub doubts: Vec<StageDoubt>,
}

/// One line of times.
#[derive(Clone, Debug, PartialEq)]
pub struct Time {
    /// File and line, for messages.
    pub place: String,
    /// The run.
    pub run: RunKey,
    /// The method.
    pub method: String,
    /// CPU seconds of all stages of the method.
    pub cpu_seconds: f64,
}

/// Reads results, and returns the digest of their file too.
pub fn read_results(path: &Path) -> anyhow::Result<(Vec<Record>, InputDigest)> {
    read(path, |place, object| {
        let format = object.get("format").and_then(Value::as_str).unwrap_or("nothing");
        let version = object.get("version").and_then(Value::as_u64).unwrap_or(0);
        if format != "posecut-result" || version != 1 {
            bail!(
                "fields `format`, `version`: found {format}, {version}, expected posecut-result, 1; collect results with posecut-experiment"
            );
        }
        let labels = labels(object)?;
        let (run, method) = key(&labels)?;
        let grouping = |name| label(&labels, name, "collect with posecut-experiment, which writes it");
        let half = match grouping("half")?.as_str() {
            "tuning" => Half::Tuning,
            "test" => Half::Test,
            other => bail!("label `half`: found \"{other}\", expected \"tuning\" or \"test\""),
        };
        Ok(Record {
            place: place.to_owned(),
            run,
            method,
            family: grouping("family")?,
            half,
            cluster: grouping("cluster")?,
            outcome: outcome(object)?,
            probabilities: bins(object)?,
            doubts: doubts(object)?,
        })
    })
}

/// Reads CPU times, and returns the digest of their file too.
pub fn read_times(path: &Path) -> anyhow::Result<(Vec<Time>, InputDigest)> {
    read(path, |place, object| {
        let (run, method) = key(&labels(object)?)?;
        let cpu_seconds = number(object, "cpu_seconds")?;
        Ok(Time { place: place.to_owned(), run, method, cpu_seconds })
    })
}

fn read<T>(
    path: &Path,
    parse: impl Fn(&str, &Map<String, Value>) -> anyhow::Result<T>,
) -> anyhow::Result<(Vec<T>, InputDigest)> {
    let file = path.display().to_string();
    let mut input = posecut_stage::open_file(path)?;
    let mut records = Vec::new();
    for (index, line) in posecut_stage::bounded_lines(&mut input).enumerate() {
        let place = format!("{file}, line {}", index + 1);
        let line = line.with_context(|| place.clone())?;
        if line.trim().is_empty() {
            continue;
        }
        let record = serde_json::from_str::<Map<String, Value>>(&line)
            .context("is not a JSON object")
            .and_then(|object| parse(&place, &object))
            .with_context(|| place.clone())?;
        records.push(record);
    }
    let sha256 = input.finish().with_context(|| format!("{file}: cannot be read"))?;
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    Ok((records, InputDigest { name, sha256 }))
}

/// Labels as text: a seed may be a number in one file and text in another.
fn labels(object: &Map<String, Value>) -> anyhow::Result<BTreeMap<String, String>> {
    let Some(Value::Object(labels)) = object.get("labels") else {
        bail!("field `labels`: is missing or not an object, expected an object of labels");
    };
    labels
        .iter()
        .map(|(name, value)| match value {
            Value::String(text) => Ok((name.clone(), text.clone())),
            Value::Number(number) => Ok((name.clone(), number.to_string())),
            Value::Bool(flag) => Ok((name.clone(), flag.to_string())),
            other => bail!("label `{name}`: found {other}, expected text or a number"),
        })
        .collect()
}

fn label(labels: &BTreeMap<String, String>, name: &str, remedy: &str) -> anyhow::Result<String> {
    match labels.get(name) {
        Some(value) if !value.is_empty() => Ok(value.clone()),
        _ => bail!("label `{name}`: is missing or empty; {remedy}"),
    }
}

fn key(labels: &BTreeMap<String, String>) -> anyhow::Result<(RunKey, String)> {
    for name in ["pipeline", "session", "seed", "method"] {
        label(labels, name, "it is needed to tell runs apart")?;
    }
    let own = |name: &&String| *name != "method" && !GROUPING.contains(&name.as_str());
    let run = labels.iter().filter(|(name, _)| own(name)).map(|(name, value)| (name.clone(), value.clone()));
    Ok((RunKey(run.collect()), labels["method"].clone()))
}

fn outcome(object: &Map<String, Value>) -> anyhow::Result<Result<Outcome, String>> {
    if let Some(failed) = object.get("failed") {
        let Some(reason) = failed.as_str().filter(|reason| !reason.trim().is_empty()) else {
            bail!("field `failed`: found {failed}, expected a sentence that says why");
        };
        if object.contains_key("rmse") {
            bail!("fields `failed` and `rmse`: a failed run has no RMSE; remove one of the two");
        }
        return Ok(Err(reason.trim().to_owned()));
    }
    let rmse = number(object, "rmse")?;
    let components = count(object, "components")?;
    let Some(Value::Object(edges)) = object.get("edges") else {
        bail!(
            "field `edges`: is missing or not an object; label the landmark edges (`truth`), so that kept and lost ones can be counted"
        );
    };
    let edge = |name: &str| count(edges, name).context("in field `edges`");
    Ok(Ok(Outcome {
        rmse,
        components,
        false_kept: edge("false_positive")?,
        correct_kept: edge("true_positive")?,
        correct_lost: edge("false_negative")?,
        truth: truth(object)?,
    }))
}

fn truth(object: &Map<String, Value>) -> anyhow::Result<Option<TruthDistance>> {
    let own = match object.get("ground_truth") {
        None | Some(Value::Null) => return Ok(None),
        Some(Value::Object(own)) => own,
        Some(other) => bail!("field `ground_truth`: found {other}, expected an object"),
    };
    let read = || -> anyhow::Result<TruthDistance> {
        let joined = own.get("joined_rmse").map(|_| number(own, "joined_rmse")).transpose()?;
        Ok(TruthDistance { own: number(own, "rmse")?, reference: number(own, "reference_rmse")?, joined })
    };
    read().context("in field `ground_truth`").map(Some)
}

fn bins(object: &Map<String, Value>) -> anyhow::Result<Option<Bins>> {
    let own = match object.get("calibration") {
        None | Some(Value::Null) => return Ok(None),
        Some(Value::Object(own)) => own,
        Some(other) => bail!("field `calibration`: found {other}, expected an object of bins"),
    };
    let read = || -> anyhow::Result<Bins> {
        let found = Bins {
            edges: ten(own, "edges", Value::as_u64)?,
            probability: ten(own, "probability", Value::as_f64)?,
            correct: ten(own, "correct", Value::as_u64)?,
        };
        for bin in 0..BINS {
            // A sum of probabilities with six decimals is exact to much less than this tolerance.
            let count = found.edges[bin] as f64;
            let (low, high) = (bin as f64 / BINS as f64, (bin + 1) as f64 / BINS as f64);
            if !(low * count - 1e-6..=high * count + 1e-6).contains(&found.probability[bin]) {
                bail!(
                    "field `probability`, bin {bin}: found {} over {}, expected {low} to {high} per edge",
                    found.probability[bin],
                    counted(usize::try_from(found.edges[bin])?, "edge")
                );
            }
            if found.correct[bin] > found.edges[bin] {
                bail!(
                    "field `correct`, bin {bin}: found {}, expected at most the {} edges of the bin",
                    found.correct[bin],
                    found.edges[bin]
                );
            }
        }
        Ok(found)
    };
    read().context("in field `calibration`").map(Some)
}

fn doubts(object: &Map<String, Value>) -> anyhow::Result<Vec<StageDoubt>> {
    let Some(value) = object.get("doubts") else { return Ok(Vec::new()) };
    serde_json::from_value(value.clone()).map_err(|_| {
        anyhow::anyhow!(
            "field `doubts`: found {value}, expected a list of objects with the texts `stage` and `doubt`"
        )
    })
}

fn ten<T>(
    object: &Map<String, Value>,
    name: &str,
    pick: fn(&Value) -> Option<T>,
) -> anyhow::Result<[T; BINS]> {
    let value = object.get(name);
    let all: Option<Vec<T>> =
        value.and_then(Value::as_array).and_then(|values| values.iter().map(pick).collect());
    all.and_then(|all| <[T; BINS]>::try_from(all).ok())
        .with_context(|| format!("field `{name}`: {}, expected {BINS} numbers of at least 0", found(value)))
}

fn number(object: &Map<String, Value>, name: &str) -> anyhow::Result<f64> {
    let value = object.get(name);
    value
        .and_then(Value::as_f64)
        .filter(|value| value.is_finite() && *value >= 0.0)
        .with_context(|| format!("field `{name}`: {}, expected a finite number of at least 0", found(value)))
}

fn count(object: &Map<String, Value>, name: &str) -> anyhow::Result<usize> {
    let value = object.get(name);
    value
        .and_then(Value::as_u64)
        .and_then(|value| usize::try_from(value).ok())
        .with_context(|| format!("field `{name}`: {}, expected a whole number of at least 0", found(value)))
}

fn found(value: Option<&Value>) -> String {
    value.map_or_else(|| "is missing".to_owned(), |value| format!("found {value}"))
}

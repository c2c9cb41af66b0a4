//! Runs with the outcome of every method.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context as _, bail};
use posecut_graph::StageDoubt;

use super::records::{Bins, Half, Outcome, Record, RunKey, Time};

/// The reference method: it knows the truth, so no method is compared with it.
pub const ORACLE: &str = "oracle";

/// A run is within the bound at `BOUND_FACTOR` times the best RMSE plus [`BOUND_MARGIN`].
pub const BOUND_FACTOR: f64 = 1.1;

/// In metres.
pub const BOUND_MARGIN: f64 = 0.1;

/// The bound in words.
pub const BOUND: &str = "1.1 × the best + 0.1 m";

/// The status of a method on a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Status {
    /// It finished.
    Done(Outcome),
    /// It did not finish, for this reason.
    Failed(String),
    /// There is no record of it.
    Missing,
}

/// One graph with one seed and one set of parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The run's key.
    pub key: RunKey,
    /// The family of the graph.
    pub family: String,
    /// The half of the family that the run belongs to.
    pub half: Half,
    /// Pipeline and cluster. Runs of one cluster are not independent of each other.
    pub cluster: String,
    /// The smallest RMSE of all methods except the oracle, metres; `None` if all failed.
    pub best: Option<f64>,
    /// One status a method, in the order of [`Benchmark::methods`].
    pub outcomes: Vec<Status>,
    /// CPU seconds in the same order, where known.
    pub seconds: Vec<Option<f64>>,
    /// Landmark edges by their probability in the same order, for methods that write probabilities.
    pub probabilities: Vec<Option<Bins>>,
    /// Doubts of the stages in the same order.
    pub doubts: Vec<BTreeSet<StageDoubt>>,
}

impl Run {
    /// The outcome of a method, if it finished.
    pub fn outcome(&self, method: usize) -> Option<Outcome> {
        match self.outcomes[method] {
            Status::Done(outcome) => Some(outcome),
            _ => None,
        }
    }

    /// RMSE of a method minus that of the best one, metres; `None` if it failed or is missing.
    pub fn regret(&self, method: usize) -> Option<f64> {
        Some(self.outcome(method)?.rmse - self.best?)
    }

    /// Whether a method is within 1.1 x the best + 0.1 m. A failed or missing one is not.
    pub fn within(&self, method: usize) -> bool {
        let bound = self.best.map(|best| BOUND_FACTOR * best + BOUND_MARGIN);
        self.outcome(method).zip(bound).is_some_and(|(outcome, bound)| outcome.rmse <= bound)
    }
}

/// All runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Benchmark {
    /// Families, by name.
    pub families: Vec<String>,
    /// Methods except the oracle, by name.
    pub methods: Vec<String>,
    /// Runs, by key.
    pub runs: Vec<Run>,
    /// Whether CPU times were given.
    pub timed: bool,
}

impl Benchmark {
    /// Builds the benchmark from records in any order.
    ///
    /// # Errors
    /// If a method has two results on one run, if a run is in two families, halves or clusters, if a time belongs to no
    /// result, or if a method has no result.
    pub fn new(records: &[Record], times: Option<&[Time]>) -> anyhow::Result<Self> {
        let mut found: BTreeMap<&RunKey, BTreeMap<&str, &Record>> = BTreeMap::new();
        for record in records {
            let run = found.entry(&record.run).or_default();
            if let Some(first) = run.insert(&record.method, record) {
                bail!(
                    "{}: method {} has a second result on the run {} (the first: {}); keep one of the two",
                    record.place,
                    record.method,
                    record.run,
                    first.place
                );
            }
        }
        let distinct = |pick: fn(&Record) -> &String| -> Vec<String> {
            let names: BTreeSet<&String> =
                records.iter().filter(|record| record.method != ORACLE).map(pick).collect();
            names.into_iter().cloned().collect()
        };
        let methods = distinct(|record| &record.method);
        if methods.is_empty() {
            bail!("no method except the oracle has a result; run the benchmark first (make trust DATA=DIR)");
        }
        let seconds = seconds(&found, times.unwrap_or_default())?;
        let mut runs = Vec::new();
        for (key, own) in found {
            same_grouping(&own)?;
            // Without any other method there is nothing to compare.
            let Some(first) = own.values().find(|record| record.method != ORACLE) else { continue };
            let outcomes: Vec<Status> =
                methods.iter().map(|method| status(own.get(method.as_str()))).collect();
            let rmse = outcomes.iter().filter_map(|outcome| match outcome {
                Status::Done(outcome) => Some(outcome.rmse),
                _ => None,
            });
            runs.push(Run {
                key: key.clone(),
                family: first.family.clone(),
                half: first.half,
                // A real and a simulated session may have the same date.
                cluster: format!("{}/{}", key.pipeline(), first.cluster),
                best: rmse.min_by(f64::total_cmp),
                seconds: methods.iter().map(|method| seconds.get(&(key, method.as_str())).copied()).collect(),
                probabilities: methods
                    .iter()
                    .map(|method| own.get(method.as_str()).and_then(|record| record.probabilities))
                    .collect(),
                doubts: methods
                    .iter()
                    .map(|method| own.get(method.as_str()).into_iter().flat_map(|record| &record.doubts))
                    .map(|doubts| doubts.cloned().collect())
                    .collect(),
                outcomes,
            });
        }
        Ok(Self { families: distinct(|record| &record.family), methods, runs, timed: times.is_some() })
    }

    /// The runs of a half, of all families or of the named one.
    pub fn of<'a>(&'a self, half: Half, family: Option<&'a str>) -> impl Iterator<Item = &'a Run> {
        let wanted = move |run: &&Run| run.half == half && family.is_none_or(|family| run.family == family);
        self.runs.iter().filter(wanted)
    }

    /// The families that have runs in a half.
    pub fn families_of(&self, half: Half) -> impl Iterator<Item = &str> {
        let present = move |family: &&str| self.of(half, Some(family)).next().is_some();
        self.families.iter().map(String::as_str).filter(present)
    }

    /// Methods by their share of runs within the bound, the largest first.
    pub fn ranking(&self, half: Half) -> Vec<usize> {
        let within = |method: usize| self.of(half, None).filter(|run| run.within(method)).count();
        let mut order: Vec<usize> = (0..self.methods.len()).collect();
        order.sort_by_key(|&method| std::cmp::Reverse(within(method)));
        order
    }
}

fn status(record: Option<&&Record>) -> Status {
    match record.map(|record| &record.outcome) {
        None => Status::Missing,
        Some(Ok(outcome)) => Status::Done(*outcome),
        Some(Err(reason)) => Status::Failed(reason.clone()),
    }
}

/// Refuses a run in both halves: constants chosen on it would be tested on it too.
fn same_grouping(own: &BTreeMap<&str, &Record>) -> anyhow::Result<()> {
    let grouping = |record: &Record| {
        [
            ("family", record.family.clone()),
            ("half", record.half.to_string()),
            ("cluster", record.cluster.clone()),
        ]
    };
    for (one, other) in own.values().zip(own.values().skip(1)) {
        for ((name, here), (_, there)) in grouping(one).into_iter().zip(grouping(other)) {
            if here != there {
                bail!(
                    "{}: label `{name}` of the run {} is \"{there}\", but {} has \"{here}\" for the same run; correct the declaration and collect again",
                    other.place,
                    other.run,
                    one.place
                );
            }
        }
    }
    Ok(())
}

type Seconds<'a> = BTreeMap<(&'a RunKey, &'a str), f64>;

fn seconds<'a>(
    found: &BTreeMap<&'a RunKey, BTreeMap<&'a str, &'a Record>>,
    times: &'a [Time],
) -> anyhow::Result<Seconds<'a>> {
    let mut seconds = Seconds::new();
    for time in times {
        found.get(&time.run).and_then(|run| run.get(time.method.as_str())).with_context(|| {
            format!(
                "{}: there is no result of method {} on the run {}; collect results and times together",
                time.place, time.method, time.run
            )
        })?;
        if seconds.insert((&time.run, &time.method), time.cpu_seconds).is_some() {
            bail!("{}: method {} has a second time on the run {}", time.place, time.method, time.run);
        }
    }
    Ok(seconds)
}

//! Calibration of probabilities: how often the landmark edges of each `verify_probability` are correct.

use posecut_stage::{counted, random};
use serde::Serialize;

use super::benchmark::{Benchmark, Run};
use super::bootstrap::{Part, interval, ratio};
use super::records::{BINS, Bins, Half};
use super::summary::{SEED, clusters};

/// The name of the group of all families.
pub const ALL: &str = "all families";

impl Bins {
    /// Adds the counts of another run.
    pub fn add(&mut self, other: &Self) {
        for bin in 0..BINS {
            self.edges[bin] += other.edges[bin];
            self.probability[bin] += other.probability[bin];
            self.correct[bin] += other.correct[bin];
        }
    }

    /// Edges in all bins.
    pub fn total(&self) -> u64 {
        self.edges.iter().sum()
    }

    /// The expected calibration error (Guo et al., ICML 2017, equation 3): the mean distance between mean probability
    /// and share of correct edges, over bins weighted by their number of edges. `None` without edges.
    pub fn error(&self) -> Option<f64> {
        // n_b / n |correct_b / n_b - probability_b / n_b| is |correct_b - probability_b| / n.
        let distances =
            self.correct.iter().zip(&self.probability).map(|(&correct, sum)| (correct as f64 - sum).abs());
        (self.total() > 0).then(|| distances.sum::<f64>() / self.total() as f64)
    }

    /// The factor on the odds of every bin's mean probability that makes the expected number of correct edges the counted one,
    /// by bisection of its logarithm.
    fn odds(&self) -> Option<f64> {
        let correct = self.correct.iter().sum::<u64>();
        let expected = |factor: f64| -> f64 {
            let of_bin = |(&edges, &sum): (&u64, &f64)| match edges as f64 {
                0.0 => 0.0,
                edges => edges / (1.0 + (edges - sum) / (sum * factor)),
            };
            self.edges.iter().zip(&self.probability).map(of_bin).sum()
        };
        let (mut low, mut high) = (-20.0_f64, 20.0_f64);
        for _ in 0..60 {
            let middle = f64::midpoint(low, high);
            if expected(middle.exp()) < correct as f64 { low = middle } else { high = middle }
        }
        (correct > 0 && correct < self.total()).then(|| low.exp())
    }
}

/// The edges in doubt: those with a probability of 0.1 to 0.9. The error over all edges says little of them, because nearly all
/// edges are near 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Doubtful {
    /// Number of edges.
    pub edges: u64,
    /// Their expected calibration error.
    pub error: f64,
    /// The factor on the odds of every bin's mean probability with which as many edges are expected to be correct as are; `None`
    /// if all or none are.
    pub odds: Option<f64>,
}

impl Doubtful {
    /// `None` without such edges.
    fn of(bins: &Bins) -> Option<Self> {
        let mut own = *bins;
        for bin in [0, BINS - 1] {
            (own.edges[bin], own.probability[bin], own.correct[bin]) = (0, 0.0, 0);
        }
        Some(Self { edges: own.total(), error: own.error()?, odds: own.odds() })
    }
}

/// How well probabilities are calibrated. Tables, figure and page share this data.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reliability {
    /// The half of the benchmark.
    pub half: String,
    /// First all families together, then each family that has probabilities.
    pub groups: Vec<Group>,
}

/// One family, or all of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Group {
    /// The family's name, or [`ALL`].
    pub name: String,
    /// Methods that write probabilities, by name.
    pub curves: Vec<Curve>,
}

/// One method on one group, with the bins pooled over runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// The method.
    pub method: String,
    /// Runs with probabilities.
    pub runs: usize,
    /// All runs of the group.
    pub of: usize,
    /// Edges with a probability and a known truth.
    pub edges: u64,
    /// Mean probability.
    pub probability: f64,
    /// Share of correct edges.
    pub correct: f64,
    /// Expected calibration error.
    pub error: f64,
    /// The edges in doubt, if there are any.
    pub doubtful: Option<Doubtful>,
    /// The bins that have edges.
    pub points: Vec<Point>,
}

/// One bin.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Its number: bin k has probabilities from k/10 to (k+1)/10.
    pub bin: usize,
    /// Number of edges.
    pub edges: u64,
    /// Their mean probability.
    pub probability: f64,
    /// Their share of correct edges.
    pub correct: f64,
    /// The 95 % interval of that share; it needs two clusters in a family.
    pub interval: Option<(f64, f64)>,
}

/// Collects the probabilities of a half; `None` if no run has any.
pub fn reliability(benchmark: &Benchmark, half: Half) -> Option<Reliability> {
    let families = benchmark.families_of(half).map(Some);
    let groups: Vec<Group> = std::iter::once(None)
        .chain(families)
        .map(|family| Group {
            name: family.unwrap_or(ALL).to_owned(),
            curves: (0..benchmark.methods.len())
                .filter_map(|method| curve(benchmark, half, family, method))
                .collect(),
        })
        .filter(|group| !group.curves.is_empty())
        .collect();
    (!groups.is_empty()).then(|| Reliability { half: half.to_string(), groups })
}

fn curve(benchmark: &Benchmark, half: Half, family: Option<&str>, method: usize) -> Option<Curve> {
    let runs: Vec<&Run> = benchmark.of(half, family).collect();
    let mut bins = Bins::default();
    let mut with = 0;
    for own in runs.iter().filter_map(|run| run.probabilities[method].as_ref()) {
        bins.add(own);
        with += 1;
    }
    let error = bins.error()?;
    let edges = bins.total();
    let name = &benchmark.methods[method];
    let point = |bin: usize| {
        let count = bins.edges[bin];
        let strata = clusters(&runs, &|run| {
            let own = run.probabilities[method].as_ref()?;
            Some(Part { above: own.correct[bin] as f64, below: own.edges[bin] as f64 })
        });
        // The random stream of a value depends only on what the value measures, not on what else is in the results.
        let purpose = format!("trust: correct in bin {bin}, {half}, {}, {name}", family.unwrap_or(ALL));
        Some(Point {
            bin,
            edges: count,
            probability: bins.probability[bin] / count as f64,
            correct: ratio(strata.iter().flatten())?,
            interval: interval(&strata, &mut random(SEED, &purpose)),
        })
    };
    Some(Curve {
        method: name.clone(),
        runs: with,
        of: runs.len(),
        edges,
        probability: bins.probability.iter().sum::<f64>() / edges as f64,
        correct: bins.correct.iter().sum::<u64>() as f64 / edges as f64,
        error,
        doubtful: Doubtful::of(&bins),
        points: (0..BINS).filter_map(point).collect(),
    })
}

/// The calibration of each method in one sentence. Markdown.
pub fn sentence(found: Option<&Reliability>, half: Half) -> String {
    let Some(found) = found else {
        return format!(
            "No result of the {half} half has probabilities: no method wrote `verify_probability`."
        );
    };
    let says = |own: &Curve| {
        let edges = |count| counted(usize::try_from(count).unwrap_or(usize::MAX), "edge");
        let mut text = format!(
            "The expected calibration error of `{}` on the {half} half is {:.4}, over {} of {}.",
            own.method,
            own.error,
            edges(own.edges),
            counted(own.runs, "run"),
        );
        if let Some(doubtful) = own.doubtful {
            text += &format!(
                " Over the {} in doubt, with a probability of 0.1 to 0.9, it is {:.3}",
                edges(doubtful.edges),
                doubtful.error
            );
            text += &doubtful.odds.map_or_else(
                || ".".to_owned(),
                |odds| format!("; their odds are {odds:.2} times what the probabilities say."),
            );
        }
        text
    };
    found.groups[0].curves.iter().map(says).collect::<Vec<_>>().join(" ")
}

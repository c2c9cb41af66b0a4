//! A method's results on one family, or on all of them.

use std::collections::BTreeMap;

use posecut_stage::random;

use super::benchmark::{Benchmark, Run, Status};
use super::bootstrap::{Part, interval, ratio};
use super::records::{Half, Outcome};

/// The seed of all resampling. It is fixed, so that the same results give the same intervals.
pub(super) const SEED: u64 = 14;

/// A value with its 95 % interval; the interval needs two clusters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// The interval.
    pub interval: Option<(f64, f64)>,
}

/// A method on the runs of a half, of one family or of all. Means, medians and worst values are over the runs that the
/// method finished.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// Number of runs, including failed and missing ones.
    pub runs: usize,
    /// Runs that the method did not finish.
    pub failed: usize,
    /// Runs without a record of the method.
    pub missing: usize,
    /// Mean RMSE, metres.
    pub mean: Option<Estimate>,
    /// Median RMSE, metres.
    pub median: Option<f64>,
    /// Largest RMSE, metres.
    pub worst: Option<f64>,
    /// Runs with a false edge in use.
    pub with_false: usize,
    /// Share of correct edges in use among all correct edges, pooled over runs; `None` without correct edges.
    pub recall: Option<Estimate>,
    /// Mean regret, metres.
    pub regret: Option<Estimate>,
    /// Largest regret, metres.
    pub worst_regret: Option<f64>,
    /// Runs whose regret is above [`LARGE_REGRET`].
    pub large_regrets: usize,
    /// Runs within 1.1 x the best + 0.1 m.
    pub within: usize,
    /// Share of these among all runs; failed and missing runs are not within the bound.
    pub share: Option<Estimate>,
    /// CPU seconds of the runs that have a time, sorted.
    pub seconds: Vec<f64>,
}

/// Regrets above this are reported by family, metres.
pub const LARGE_REGRET: f64 = 5.0;

impl Summary {
    /// Runs that the method finished.
    pub fn done(&self) -> usize {
        self.runs - self.failed - self.missing
    }
}

/// Summarises a method.
pub fn summary(benchmark: &Benchmark, half: Half, family: Option<&str>, method: usize) -> Summary {
    let runs: Vec<&Run> = benchmark.of(half, family).collect();
    let name = &benchmark.methods[method];
    let estimate = |what: &str, part: &dyn Fn(&Run) -> Option<Part>| {
        let strata = clusters(&runs, part);
        // The random stream of a value depends only on what the value measures, not on what else is in the results.
        let purpose = format!("trust: {what}, {half}, {}, {name}", family.unwrap_or("all families"));
        let value = ratio(strata.iter().flatten())?;
        Some(Estimate { value, interval: interval(&strata, &mut random(SEED, &purpose)) })
    };
    let outcomes: Vec<Outcome> = runs.iter().filter_map(|run| run.outcome(method)).collect();
    let regrets: Vec<f64> = runs.iter().filter_map(|run| run.regret(method)).collect();
    let count = |wanted: &dyn Fn(&Run) -> bool| runs.iter().filter(|run| wanted(run)).count();
    let one = |above: f64| Part { above, below: 1.0 };
    let mut errors: Vec<f64> = outcomes.iter().map(|outcome| outcome.rmse).collect();
    errors.sort_by(f64::total_cmp);
    let mut seconds: Vec<f64> = runs.iter().filter_map(|run| run.seconds[method]).collect();
    seconds.sort_by(f64::total_cmp);
    Summary {
        runs: runs.len(),
        failed: count(&|run| matches!(run.outcomes[method], Status::Failed(_))),
        missing: count(&|run| run.outcomes[method] == Status::Missing),
        mean: estimate("RMSE", &|run| Some(one(run.outcome(method)?.rmse))),
        median: median(&errors),
        worst: errors.last().copied(),
        with_false: outcomes.iter().filter(|outcome| outcome.false_kept > 0).count(),
        recall: estimate("recall", &|run| Some(correct_edges(&run.outcome(method)?))),
        regret: estimate("regret", &|run| Some(one(run.regret(method)?))),
        worst_regret: regrets.iter().copied().max_by(f64::total_cmp),
        large_regrets: regrets.iter().filter(|regret| **regret > LARGE_REGRET).count(),
        within: count(&|run| run.within(method)),
        share: estimate("share within", &|run| Some(one(f64::from(u8::from(run.within(method)))))),
        seconds,
    }
}

/// The correct edges that a run keeps, of all of them. Their ratio over runs is the pooled recall.
pub(super) fn correct_edges(outcome: &Outcome) -> Part {
    let kept = outcome.correct_kept as f64;
    Part { above: kept, below: kept + outcome.correct_lost as f64 }
}

/// The median of sorted values.
pub fn median(sorted: &[f64]) -> Option<f64> {
    let upper = *sorted.get(sorted.len() / 2)?;
    Some(if sorted.len() % 2 == 1 { upper } else { f64::midpoint(sorted[sorted.len() / 2 - 1], upper) })
}

/// The sums of each cluster, by family. A cluster without a value remains, with a denominator of zero.
pub(super) fn clusters(runs: &[&Run], part: &dyn Fn(&Run) -> Option<Part>) -> Vec<Vec<Part>> {
    let mut families: BTreeMap<&str, BTreeMap<&str, Part>> = BTreeMap::new();
    for run in runs {
        let sum = families.entry(&run.family).or_default().entry(&run.cluster).or_default();
        if let Some(own) = part(run) {
            sum.above += own.above;
            sum.below += own.below;
        }
    }
    families.into_values().map(|clusters| clusters.into_values().collect()).collect()
}

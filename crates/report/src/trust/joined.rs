//! How far from the ground truth the maps are that methods claim: the parts that the edges in use connect, each aligned by itself.
//!
//! The RMSE against the optimum of the correct edges does not see a false join between parts that no correct edge joins, and where a
//! join is missing it measures the arbitrary pose of one part relative to another. This measure is the other way round.

use super::benchmark::{Benchmark, Run};
use super::bootstrap::{Part, ratio};
use super::records::{Half, Outcome};
use super::summary::{correct_edges, median};
use super::tables::{NONE, Table, optional, share, with_head};
use crate::table::metres;
use posecut_stage::counted;

/// The row of the optimum of the correct edges.
const OPTIMUM: &str = "*optimum of the correct edges*";

/// A row for each method, after one for the optimum of the correct edges; `None` if no result of the half has the measure, as in
/// results without ground truth or of older programs.
pub fn joined(benchmark: &Benchmark, half: Half) -> Option<Table> {
    let runs = measured(benchmark, half);
    let families: Vec<&str> =
        benchmark.families_of(half).filter(|family| runs.iter().any(|run| run.family == *family)).collect();
    // One family is all families.
    let families = if families.len() > 1 { families } else { Vec::new() };
    let row = |name: &str, value: &dyn Fn(&Run) -> Option<f64>| {
        let means = families.iter().map(|family| mean(&values(&runs, Some(family), value)));
        let all = values(&runs, None, value);
        let mut row = vec![name.to_owned(), all.len().to_string()];
        row.extend(means.chain([mean(&all), median(&all), all.last().copied()]).map(optional));
        row
    };
    let optimum = [row(OPTIMUM, &reference), vec![NONE.to_owned(), NONE.to_owned()]].concat();
    let methods = benchmark.ranking(half).into_iter().map(|method| {
        let has = |run: &&&Run| of(method)(run).is_some();
        let outcomes: Vec<Outcome> = runs.iter().filter(has).filter_map(|run| run.outcome(method)).collect();
        let parts: Vec<f64> = outcomes.iter().map(|outcome| outcome.components as f64).collect();
        let correct: Vec<Part> = outcomes.iter().map(correct_edges).collect();
        let mut row = row(&benchmark.methods[method], &of(method));
        row.push(mean(&parts).map_or_else(|| NONE.to_owned(), |parts| format!("{parts:.2}")));
        row.push(ratio(correct.iter()).map_or_else(|| NONE.to_owned(), share));
        row
    });
    let head: Vec<&str> =
        ["method", "runs"].into_iter().chain(families.iter().copied()).chain(HEAD_OF_ALL).collect();
    (!runs.is_empty()).then(|| Table {
        title: format!("Distance of what is joined from the ground truth, {half} half"),
        note: NOTE.to_owned(),
        cells: with_head(&head, std::iter::once(optimum).chain(methods)),
    })
}

/// The means of a method, of the closest other one that finished all runs, and of the optimum of the correct edges, in a sentence.
pub fn sentence(benchmark: &Benchmark, half: Half, chosen: usize) -> Option<String> {
    let runs = measured(benchmark, half);
    let all = |value: &dyn Fn(&Run) -> Option<f64>| {
        let values = values(&runs, None, value);
        (values.len() == runs.len()).then(|| mean(&values)).flatten()
    };
    let own = all(&of(chosen))?;
    let others = (0..benchmark.methods.len()).filter(|&method| method != chosen);
    let (next, distance) = others
        .filter_map(|method| Some((method, all(&of(method))?)))
        .min_by(|(_, one), (_, other)| one.total_cmp(other))?;
    Some(format!(
        "On average, what `{}` joins is {} m from the ground truth, the optimum of the correct edges {} m, and what the next method (`{}`) joins {} m ({} with a ground truth; each joined part is aligned by itself).",
        benchmark.methods[chosen],
        metres(own),
        metres(all(&reference)?),
        benchmark.methods[next],
        metres(distance),
        counted(runs.len(), "run"),
    ))
}

/// The measure of a method on a run.
fn of(method: usize) -> impl Fn(&Run) -> Option<f64> {
    move |run| run.outcome(method)?.truth?.joined
}

/// The distance of the optimum of the correct edges, which every result repeats.
fn reference(run: &Run) -> Option<f64> {
    (0..run.outcomes.len()).find_map(|method| Some(run.outcome(method)?.truth?.reference))
}

/// The runs with the measure.
fn measured(benchmark: &Benchmark, half: Half) -> Vec<&Run> {
    let has = |run: &&Run| (0..benchmark.methods.len()).any(|method| of(method)(run).is_some());
    benchmark.of(half, None).filter(has).collect()
}

const HEAD_OF_ALL: [&str; 5] = ["mean, m", "median", "worst", "parts", "recall"];

const NOTE: &str = "Each part that the edges in use connect is aligned to the ground truth by itself: a false join counts, a missing one does not. So read the mean RMSE beside the mean number of *parts* and the recall. Only finished runs with a ground truth count. The first row is that of the optimum of the correct edges, which the errors of odometry bend.";

/// The values of the runs that have one, sorted.
fn values(runs: &[&Run], family: Option<&str>, value: &dyn Fn(&Run) -> Option<f64>) -> Vec<f64> {
    let wanted = |run: &&&Run| family.is_none_or(|family| run.family == family);
    let mut values: Vec<f64> = runs.iter().filter(wanted).filter_map(|run| value(run)).collect();
    values.sort_by(f64::total_cmp);
    values
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

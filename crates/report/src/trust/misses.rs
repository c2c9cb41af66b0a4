//! The runs on which a method misses the bound, beside the ground truth.

use super::benchmark::{BOUND, Benchmark, Run};
use super::records::{Half, Outcome, TruthDistance};
use super::tables::{NONE, Table, optional, with_head};

/// One row for each run on which the method is not within the bound, the largest regret first.
pub fn misses(benchmark: &Benchmark, half: Half, method: usize) -> Table {
    let mut missed: Vec<&Run> = benchmark.of(half, None).filter(|run| !run.within(method)).collect();
    let regret = |run: &Run| run.regret(method).unwrap_or(f64::INFINITY);
    missed.sort_by(|one, other| regret(other).total_cmp(&regret(one)));
    let head = [
        "family",
        "run",
        "RMSE, m",
        "best, m",
        "best method",
        "false kept",
        "correct lost",
        "from the truth, m",
        "optimum from the truth, m",
        "what it joins from the truth, m",
    ];
    let rows = missed.iter().map(|run| row(benchmark, run, method));
    let name = &benchmark.methods[method];
    let truths: Vec<TruthDistance> = missed.iter().filter_map(|run| run.outcome(method)?.truth).collect();
    Table {
        title: format!("Runs on which {name} misses the bound, {half} half"),
        note: format!(
            "The bound is {BOUND}. *Optimum*: the optimum of the correct edges, to which all RMSEs are measured. It is not the truth: where odometry is broken, the correct edges bend it. On {} of {} of these runs with a ground truth, the map of {name} is at least as close to the truth as the optimum is. *What it joins*: with an alignment for each part that its edges in use connect; this is small where edges are missing, not wrong.",
            truths.iter().filter(|truth| truth.own <= truth.reference).count(),
            truths.len()
        ),
        cells: with_head(&head, rows),
    }
}

fn row(benchmark: &Benchmark, run: &Run, method: usize) -> Vec<String> {
    let best = (0..benchmark.methods.len())
        .filter_map(|other| Some((other, run.outcome(other)?.rmse)))
        .min_by(|one, other| one.1.total_cmp(&other.1));
    let own: Option<Outcome> = run.outcome(method);
    let truth = own.and_then(|own| own.truth);
    vec![
        run.family.clone(),
        run.key.short(),
        optional(own.map(|own| own.rmse)),
        optional(run.best),
        best.map_or_else(|| NONE.to_owned(), |(other, _)| benchmark.methods[other].clone()),
        own.map_or_else(|| NONE.to_owned(), |own| own.false_kept.to_string()),
        own.map_or_else(
            || NONE.to_owned(),
            |own| format!("{} of {}", own.correct_lost, own.correct_lost + own.correct_kept),
        ),
        optional(truth.map(|truth| truth.own)),
        optional(truth.map(|truth| truth.reference)),
        optional(truth.and_then(|truth| truth.joined)),
    ]
}

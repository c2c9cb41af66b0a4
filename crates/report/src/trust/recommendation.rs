//! Recommends a method, and says in sentences what can go wrong with it. A rule chooses the method on the tuning half
//! alone; the test half then shows how good the choice is.

use std::fmt::Write as _;

use anyhow::{Context as _, bail};
use posecut_stage::counted;

use super::benchmark::{BOUND, Benchmark, Status};
use super::records::Half;
use super::summary::{LARGE_REGRET, Summary, summary};
use super::tables::{finished, percent, whole};
use crate::table::{inline, metres};

/// The method with the most runs within the bound on the tuning half, among those that have a record for each of its
/// runs. A tie is decided by the smaller worst regret, then by name. A method with a failed run has no worst regret and
/// loses every tie.
///
/// # Errors
/// If the tuning half has no runs, or no method has a record for all of them.
pub fn recommended(benchmark: &Benchmark) -> anyhow::Result<usize> {
    if benchmark.of(Half::Tuning, None).next().is_none() {
        bail!(
            "the results have no run of the tuning half, which decides the recommended method; run the benchmark on both halves"
        );
    }
    let complete =
        |method: &usize| benchmark.of(Half::Tuning, None).all(|run| run.outcomes[*method] != Status::Missing);
    let within = |method: usize| benchmark.of(Half::Tuning, None).filter(|run| run.within(method)).count();
    let worst = |method: usize| {
        let regret = |run: &super::Run| run.regret(method).unwrap_or(f64::INFINITY);
        benchmark.of(Half::Tuning, None).map(regret).fold(0.0, f64::max)
    };
    (0..benchmark.methods.len())
        .filter(complete)
        .min_by(|&one, &other| {
            within(other).cmp(&within(one)).then_with(|| worst(one).total_cmp(&worst(other)))
        })
        .context(
            "no method has a record for every run of the tuning half, so none can be recommended; finish the benchmark",
        )
}

/// The recommended method, its figures on the test half, and the families where it goes wrong. Markdown.
///
/// # Errors
/// As [`recommended`], or if the test half has no runs.
pub fn answer(benchmark: &Benchmark) -> anyhow::Result<String> {
    let chosen = recommended(benchmark)?;
    if benchmark.of(Half::Test, None).next().is_none() {
        bail!(
            "the results have no run of the test half, which judges the methods; run the benchmark on both halves"
        );
    }
    let name = &benchmark.methods[chosen];
    let tuning = summary(benchmark, Half::Tuning, None, chosen);
    let test = summary(benchmark, Half::Test, None, chosen);
    let share = |own: &Summary| own.share.map_or_else(String::new, percent);
    let mut text = format!(
        "**Use `{name}`.** Of the {}, it is within {BOUND} on the most runs of the tuning half: {} of {}. On the test half, \
         where no constant was chosen, it is within that bound on {} of {}, keeps a false edge in {}, and its worst regret is {}.",
        counted(benchmark.methods.len(), "method"),
        share(&tuning),
        counted(tuning.runs, "run"),
        share(&test),
        counted(test.runs, "run"),
        test.with_false,
        worst(&test),
    );
    // Writing to a string cannot fail.
    let _ = write!(text, "{}\n\n", others(benchmark, chosen));
    wrong(&mut text, benchmark, chosen);
    let _ = write!(text, "\n{}", safety(benchmark));
    Ok(text)
}

/// Methods that are better than the chosen one on the test half.
fn others(benchmark: &Benchmark, chosen: usize) -> String {
    let share = |method: usize| {
        let own = summary(benchmark, Half::Test, None, method);
        (own.within, own.share.map_or_else(String::new, percent))
    };
    let first = benchmark.ranking(Half::Test)[0];
    let (own, best) = (share(chosen), share(first));
    if best.0 > own.0 {
        format!(" On the test half `{}` does better: {}.", benchmark.methods[first], best.1)
    } else {
        " No method does better on the test half.".to_owned()
    }
}

/// One line for each family in which the method keeps a false edge, has a large regret, or does not finish.
fn wrong(text: &mut String, benchmark: &Benchmark, chosen: usize) {
    let name = &benchmark.methods[chosen];
    let lines: Vec<String> = benchmark
        .families_of(Half::Test)
        .filter_map(|family| {
            let wrong = mistakes(&summary(benchmark, Half::Test, Some(family), chosen));
            (!wrong.is_empty()).then(|| format!("- **{}**: {}.", inline(family), wrong.join("; ")))
        })
        .collect();
    let families =
        counted(benchmark.families_of(Half::Test).count(), "family").replace("familys", "families");
    // Writing to a string cannot fail.
    let _ = if lines.is_empty() {
        writeln!(
            text,
            "On the test half `{name}` finishes every run of {families}, keeps no false edge, and has no regret above {LARGE_REGRET} m."
        )
    } else {
        writeln!(
            text,
            "What goes wrong with `{name}` on the test half, in {} of {families}:\n\n{}",
            lines.len(),
            lines.join("\n")
        )
    };
}

fn mistakes(own: &Summary) -> Vec<String> {
    let mut wrong = Vec::new();
    if own.with_false > 0 {
        wrong.push(format!("keeps a false edge in {} of {}", own.with_false, counted(own.done(), "run")));
    }
    if own.large_regrets > 0 {
        wrong.push(format!(
            "regret above {LARGE_REGRET} m in {} of {} (worst {} m)",
            own.large_regrets,
            counted(own.done(), "run"),
            own.worst_regret.map_or_else(String::new, metres)
        ));
    }
    if own.failed + own.missing > 0 {
        wrong.push(format!("finishes {} runs", finished(own)));
    }
    if own.done() == 0 {
        wrong = vec![format!("finishes none of {}", counted(own.runs, "run"))];
    }
    wrong
}

fn worst(own: &Summary) -> String {
    let regret =
        own.worst_regret.map_or_else(|| "unknown".to_owned(), |regret| format!("{} m", metres(regret)));
    match own.failed + own.missing {
        0 => regret,
        count => format!("{regret}, {} without a result aside", counted(count, "run")),
    }
}

/// Whether any method is safe everywhere, and which one has the smallest worst regret.
fn safety(benchmark: &Benchmark) -> String {
    let summaries: Vec<(usize, Summary)> = (0..benchmark.methods.len())
        .map(|method| (method, summary(benchmark, Half::Test, None, method)))
        .collect();
    let names = |methods: Vec<usize>| {
        let names: Vec<String> =
            methods.into_iter().map(|method| format!("`{}`", benchmark.methods[method])).collect();
        names.join(", ")
    };
    let safe = |own: &Summary| mistakes(own).is_empty();
    let safe: Vec<usize> = summaries.iter().filter(|(_, own)| safe(own)).map(|(method, _)| *method).collect();
    let mut text = if safe.is_empty() {
        format!(
            "**No method is safe**: each keeps a false edge, has a regret above {LARGE_REGRET} m, or does not finish on at least one test run."
        )
    } else {
        format!("Without any such mistake on the test half: {}.", names(safe))
    };
    let finished = summaries.iter().filter(|(_, own)| own.done() == own.runs);
    let smallest = finished
        .filter_map(|(method, own)| Some((*method, own.worst_regret?, own.within)))
        .min_by(|one, other| one.1.total_cmp(&other.1));
    if let Some((method, regret, within)) = smallest {
        let runs = summaries[method].1.runs;
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            " The smallest worst regret of the methods that finish every test run is that of `{}`: {} m, at {} of the runs within the bound.",
            benchmark.methods[method],
            metres(regret),
            whole(within as f64 / runs as f64)
        );
    }
    text
}

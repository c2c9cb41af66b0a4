//! Tables of the benchmark, for both Markdown and the page.

use std::collections::{BTreeMap, BTreeSet};

use posecut_graph::StageDoubt;

use super::benchmark::{BOUND, Benchmark, Status};
use super::joined::joined;
use super::records::{BINS, Half};
use super::reliability::{Point, Reliability, reliability};
use super::summary::{Estimate, LARGE_REGRET, Summary, median, summary};
use crate::table::{grid, inline, metres};

/// A table with a heading and a sentence on how to read it.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The heading.
    pub title: String,
    /// The text below the title; may be empty.
    pub note: String,
    /// Rows of cells; the first is the head.
    pub cells: Vec<Vec<String>>,
}

impl Table {
    /// The table as Markdown, under a heading of the third level.
    pub fn markdown(&self) -> String {
        let note = if self.note.is_empty() { String::new() } else { format!("{}\n\n", self.note) };
        let mut text = format!("### {}\n\n{note}", inline(&self.title));
        if self.cells.len() > 1 {
            grid(&mut text, &self.cells);
        }
        text
    }
}

/// The cell of a value that does not exist.
pub(super) const NONE: &str = "–";

/// All tables of a half, in the order of the document.
pub fn tables(benchmark: &Benchmark, half: Half) -> Vec<Table> {
    let mut tables = vec![overall(benchmark, half), matrix(benchmark, half)];
    tables.extend(joined(benchmark, half));
    tables.extend(families(benchmark, half));
    tables.extend(reliability(benchmark, half).iter().flat_map(calibration));
    tables.push(failures(benchmark, half));
    tables.extend(doubts(benchmark, half));
    tables.extend(time(benchmark, half));
    tables.push(counts(benchmark));
    tables
}

/// All methods over all families, sorted by the share of runs within the bound, largest first.
pub fn overall(benchmark: &Benchmark, half: Half) -> Table {
    let head =
        ["method", "runs", "within the bound", "with a false edge", "regret above 5 m", "worst regret, m"];
    let rows = benchmark.ranking(half).into_iter().map(|method| {
        let own = summary(benchmark, half, None, method);
        vec![
            benchmark.methods[method].clone(),
            finished(&own),
            own.share.map_or_else(|| NONE.to_owned(), percent),
            own.with_false.to_string(),
            own.large_regrets.to_string(),
            optional(own.worst_regret),
        ]
    });
    Table {
        title: format!("All families, {half} half"),
        note: format!(
            "*Within the bound*: share of all runs with an RMSE of at most {BOUND}, with its 95 % interval; a run that failed or is missing is not within. The other columns count finished runs."
        ),
        cells: with_head(&head, rows),
    }
}

/// The share within the bound by method and family.
pub fn matrix(benchmark: &Benchmark, half: Half) -> Table {
    let families: Vec<&str> = benchmark.families_of(half).collect();
    let head: Vec<&str> = std::iter::once("method").chain(families.iter().copied()).collect();
    let rows = benchmark.ranking(half).into_iter().map(|method| {
        let share = |family: &&str| {
            let own = summary(benchmark, half, Some(family), method);
            own.share.map_or_else(|| NONE.to_owned(), |share| whole(share.value))
        };
        std::iter::once(benchmark.methods[method].clone()).chain(families.iter().map(share)).collect()
    });
    Table {
        title: format!("Share of runs within {BOUND}, {half} half"),
        note: String::new(),
        cells: with_head(&head, rows),
    }
}

/// One table a family.
pub fn families(benchmark: &Benchmark, half: Half) -> Vec<Table> {
    let ranking = benchmark.ranking(half);
    let table = |family: &str| {
        let head = [
            "method",
            "runs",
            "RMSE mean, m",
            "median",
            "worst",
            "with a false edge",
            "recall",
            "regret mean, m",
            "worst",
        ];
        let rows = ranking.iter().map(|&method| {
            let own = summary(benchmark, half, Some(family), method);
            vec![
                benchmark.methods[method].clone(),
                finished(&own),
                length(own.mean),
                optional(own.median),
                optional(own.worst),
                format!("{} of {}", own.with_false, own.done()),
                own.recall.map_or_else(|| NONE.to_owned(), recall),
                length(own.regret),
                optional(own.worst_regret),
            ]
        });
        let runs = benchmark.of(half, Some(family));
        let clusters: BTreeSet<&str> = runs.map(|run| run.cluster.as_str()).collect();
        let note = if clusters.len() < 2 {
            "One session, sequence or graph only: there are no intervals."
        } else {
            ""
        };
        Table {
            title: format!("{family}, {half} half"),
            note: note.to_owned(),
            cells: with_head(&head, rows),
        }
    };
    benchmark.families_of(half).map(table).collect()
}

/// The calibration of probabilities: errors by family, then the bins of all families.
pub fn calibration(found: &Reliability) -> [Table; 2] {
    let all = found.groups.iter().flat_map(|group| group.curves.iter().map(move |own| (&group.name, own)));
    let errors = all.map(|(name, own)| {
        vec![
            own.method.clone(),
            name.clone(),
            if own.runs == own.of { own.runs.to_string() } else { format!("{} of {}", own.runs, own.of) },
            own.edges.to_string(),
            share(own.probability),
            share(own.correct),
            format!("{:.4}", own.error),
        ]
    });
    let errors = Table {
        title: format!("Calibration of probabilities, {} half", found.half),
        note: "*Calibration error*: the expected calibration error over ten bins of `verify_probability`, weighted by their edges. Edges are pooled over the runs that have probabilities, so that a run with many edges weighs more.".to_owned(),
        cells: with_head(
            &["method", "family", "runs", "edges", "mean probability", "share correct", "calibration error"],
            errors,
        ),
    };
    let rows = found.groups[0].curves.iter().flat_map(|own| {
        (0..BINS).map(|bin| {
            let point = own.points.iter().find(|point| point.bin == bin);
            let value = |pick: &dyn Fn(&Point) -> String| point.map_or_else(|| NONE.to_owned(), pick);
            vec![
                own.method.clone(),
                format!("{:.1} to {:.1}", bin as f64 / BINS as f64, (bin + 1) as f64 / BINS as f64),
                point.map_or(0, |point| point.edges).to_string(),
                value(&|point| share(point.probability)),
                value(&|point| recall(Estimate { value: point.correct, interval: point.interval })),
            ]
        })
    });
    let bins = Table {
        title: format!("Edges by probability, all families, {} half", found.half),
        note: "The share of correct edges has its 95 % interval.".to_owned(),
        cells: with_head(&["method", "probability", "edges", "mean probability", "share correct"], rows),
    };
    [errors, bins]
}

/// Failed and missing runs, by reason.
pub fn failures(benchmark: &Benchmark, half: Half) -> Table {
    let mut found: BTreeMap<(&str, &str, &str), usize> = BTreeMap::new();
    for run in benchmark.of(half, None) {
        for (method, outcome) in benchmark.methods.iter().zip(&run.outcomes) {
            let reason = match outcome {
                Status::Done(_) => continue,
                Status::Failed(reason) => reason,
                Status::Missing => "missing: there is no record of it",
            };
            *found.entry((method, &run.family, reason)).or_default() += 1;
        }
    }
    let note = if found.is_empty() { "Every method finished every run." } else { "" };
    let rows = found.into_iter().map(|((method, family, reason), count)| {
        vec![method.to_owned(), family.to_owned(), count.to_string(), reason.to_owned()]
    });
    Table {
        title: format!("Runs without a result, {half} half"),
        note: note.to_owned(),
        cells: with_head(&["method", "family", "runs", "what happened"], rows),
    }
}

/// Number of runs with each doubt, by method; `None` if no result has doubts, as in results of older programs. It
/// replaces daggers in the other tables, whose cells combine many runs.
pub fn doubts(benchmark: &Benchmark, half: Half) -> Option<Table> {
    let mut found: BTreeMap<(&str, &StageDoubt), usize> = BTreeMap::new();
    let mut runs: BTreeMap<&str, usize> = BTreeMap::new();
    for run in benchmark.of(half, None) {
        for (method, (outcome, doubts)) in benchmark.methods.iter().zip(run.outcomes.iter().zip(&run.doubts))
        {
            *runs.entry(method).or_default() += usize::from(matches!(outcome, Status::Done(_)));
            for doubt in doubts {
                *found.entry((method, doubt)).or_default() += 1;
            }
        }
    }
    let rows = found.iter().map(|(&(method, doubt), count)| {
        vec![
            method.to_owned(),
            doubt.stage.clone(),
            doubt.doubt.clone(),
            format!("{count} of {}", runs[method]),
        ]
    });
    (!found.is_empty()).then(|| Table {
        title: format!("Doubts, {half} half"),
        note: "Finished runs of which a stage says that the result should not be believed without a look; docs/doubts.md explains the doubts.".to_owned(),
        cells: with_head(&["method", "stage", "doubt", "runs"], rows),
    })
}

/// CPU time by method; `None` if no times were given.
pub fn time(benchmark: &Benchmark, half: Half) -> Option<Table> {
    let rows = benchmark.ranking(half).into_iter().map(|method| {
        let own = summary(benchmark, half, None, method);
        vec![
            benchmark.methods[method].clone(),
            format!("{} of {}", own.seconds.len(), own.runs),
            median(&own.seconds).map_or_else(|| NONE.to_owned(), seconds),
            own.seconds.last().copied().map_or_else(|| NONE.to_owned(), seconds),
        ]
    });
    benchmark.timed.then(|| Table {
        title: format!("CPU seconds a run, {half} half"),
        note: "All stages of a method together, runs that failed included.".to_owned(),
        cells: with_head(&["method", "runs with a time", "median", "slowest"], rows),
    })
}

/// The number of runs and clusters of each family.
pub fn counts(benchmark: &Benchmark) -> Table {
    let rows = benchmark.families.iter().map(|family| {
        let count = |half: Half| {
            let runs = benchmark.of(half, Some(family));
            let clusters: BTreeSet<&str> = runs.map(|run| run.cluster.as_str()).collect();
            [benchmark.of(half, Some(family)).count().to_string(), clusters.len().to_string()]
        };
        [vec![family.clone()], count(Half::Tuning).to_vec(), count(Half::Test).to_vec()].concat()
    });
    let head = ["family", "tuning runs", "clusters", "test runs", "clusters"];
    Table {
        title: "Runs and clusters".to_owned(),
        note: "A cluster is a session, a sequence or a graph: runs of one cluster are not independent."
            .to_owned(),
        cells: with_head(&head, rows),
    }
}

pub(super) fn with_head(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Vec<Vec<String>> {
    std::iter::once(head.iter().map(|&name| name.to_owned()).collect()).chain(rows).collect()
}

/// `40`, or `38 of 40 (1 failed, 1 missing)`.
pub fn finished(own: &Summary) -> String {
    let mut why = Vec::new();
    for (count, word) in [(own.failed, "failed"), (own.missing, "missing")] {
        if count > 0 {
            why.push(format!("{count} {word}"));
        }
    }
    if why.is_empty() {
        own.runs.to_string()
    } else {
        format!("{} of {} ({})", own.done(), own.runs, why.join(", "))
    }
}

/// A share in whole percent. A share between 0 and 1 is never rounded to 0 or 100.
pub fn whole(share: f64) -> String {
    let percent = match share {
        _ if share <= 0.0 => 0.0,
        _ if share >= 1.0 => 100.0,
        _ => (100.0 * share).round().clamp(1.0, 99.0),
    };
    format!("{percent:.0} %")
}

/// A share in percent with its interval.
pub fn percent(share: Estimate) -> String {
    let brief = |value: f64| whole(value).trim_end_matches(" %").to_owned();
    match share.interval {
        Some((low, high)) => format!("{} [{}, {}]", whole(share.value), brief(low), brief(high)),
        None => whole(share.value),
    }
}

/// A recall with three decimals. It is 1.000 only if nothing was lost, and 0.000 only if nothing was kept.
pub(super) fn recall(own: Estimate) -> String {
    let brief = |value: f64| {
        let inside = value > 0.0 && value < 1.0;
        format!("{:.3}", if inside { value.clamp(0.001, 0.999) } else { value })
    };
    match own.interval {
        Some((low, high)) => format!("{} [{}, {}]", brief(own.value), brief(low), brief(high)),
        None => brief(own.value),
    }
}

/// A share without an interval, with three decimals.
pub(super) fn share(value: f64) -> String {
    recall(Estimate { value, interval: None })
}

fn length(own: Option<Estimate>) -> String {
    match own {
        None => NONE.to_owned(),
        Some(Estimate { value, interval: None }) => metres(value),
        Some(Estimate { value, interval: Some((low, high)) }) => {
            format!("{} [{}, {}]", metres(value), metres(low), metres(high))
        }
    }
}

/// A length, metres, or the cell of a value that does not exist.
pub(super) fn optional(value: Option<f64>) -> String {
    value.map_or_else(|| NONE.to_owned(), metres)
}

fn seconds(value: f64) -> String {
    if value < 10.0 { format!("{value:.2}") } else { format!("{value:.0}") }
}

const _: () = assert!(LARGE_REGRET == 5.0, "the head of the table of all families names it");

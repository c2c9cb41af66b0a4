//! Measures generated graphs of growing size.

use serde::Deserialize;
use serde_json::{Value, json};

use super::pinned::{Pinned, given};
use super::{Named, Results, named};
use crate::markdown;
use crate::measure::programs::bench_program;
use crate::numbers::thousands;

const SIZES: [(&str, &[u64]); 2] = [
    ("manhattan", &[1000, 10_000, 100_000, 300_000, 1_000_000]),
    ("sphere", &[1000, 10_000, 30_000, 100_000, 300_000, 1_000_000]),
];

#[derive(Deserialize)]
#[serde(transparent)]
pub(super) struct Kinds(#[serde(deserialize_with = "named")] Named<Sizes>);

#[derive(Deserialize)]
#[serde(transparent)]
struct Sizes(#[serde(deserialize_with = "named")] Named<Entry>);

#[derive(Deserialize)]
#[serde(untagged)]
enum Entry {
    Failed { failed: String },
    Run(Run),
}

/// The output of the bench `growth`.
#[derive(Deserialize)]
struct Run {
    poses: u64,
    edges: u64,
    seconds: f64,
    with_two: Option<f64>,
    peak_megabytes: f64,
    factor_blocks: f64,
    factor_megabytes: f64,
    iterations: u64,
    factorizations: u64,
    start: String,
    chi_square_per_freedom: f64,
}

pub(super) fn measure(only: &[u64], results: &mut Results) -> anyhow::Result<()> {
    let (bench, most_with_two) =
        (bench_program("posecut-optimize", "growth")?, given("MOST_WITH_TWO", 300_000.0)?);
    for (kind, sizes) in SIZES {
        for &size in sizes.iter().filter(|size| only.is_empty() || only.contains(size)) {
            let number = size.to_string();
            let words = [kind, &number];
            let run = Pinned::new(&bench, 1).words(&words).run()?;
            let failed = run.is_err();
            let entry = match run {
                Err(why) => json!({"failed": why}),
                Ok(run) => {
                    let mut entry: Value = serde_json::from_slice(&run.output)?;
                    if size as f64 <= most_with_two {
                        let both = Pinned::new(&bench, 2).words(&words).must()?;
                        entry["with_two"] = serde_json::from_slice::<Value>(&both.output)?["seconds"].clone();
                    }
                    entry
                }
            };
            println!("{kind} {size} {entry}");
            results.keep(&["growth", kind, &number], entry)?;
            // Larger graphs would fail too.
            if failed {
                break;
            }
        }
    }
    Ok(())
}

pub(super) fn table(found: &Kinds) -> anyhow::Result<String> {
    let head = [
        "graph",
        "poses",
        "edges",
        "s",
        "with two threads, s",
        "peak MB",
        "factor, blocks per pose",
        "factor, MB",
        "steps (factorisations)",
        "start",
        "chi-square per freedom",
    ];
    let mut lines = markdown::table(&markdown::cells(&head), head.len(), &[]);
    for (kind, sizes) in &found.0 {
        for (size, entry) in &sizes.0 {
            lines.push(match entry {
                Entry::Failed { failed } => {
                    format!("| {kind} | {} | | {failed} | | | | | | | |", thousands(size.parse()?))
                }
                Entry::Run(run) => markdown::row(&cells(kind, run)),
            });
        }
    }
    Ok(lines.join("\n"))
}

fn cells(kind: &str, run: &Run) -> [String; 11] {
    [
        kind.to_owned(),
        thousands(run.poses),
        thousands(run.edges),
        format!("{:.3}", run.seconds),
        run.with_two.map_or_else(String::new, |seconds| format!("{seconds:.3}")),
        format!("{:.0}", run.peak_megabytes),
        format!("{:.1}", run.factor_blocks / run.poses as f64),
        format!("{:.1}", run.factor_megabytes),
        format!("{} ({})", run.iterations, run.factorizations),
        run.start.clone(),
        format!("{:.3}", run.chi_square_per_freedom),
    ]
}

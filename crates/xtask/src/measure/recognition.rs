//! Measures place recognition on real laser logs, from the log to the map, for docs/results/recognition.md.

mod graph;
mod ranking;
mod running;
mod tables;

use std::path::PathBuf;

use clap::Args;
use xtask::sections::replace;
use xtask::workspace::{root, shared_data};

use crate::Verdict;
use crate::machine::{Machine, today};
use graph::Map;
use ranking::Scored;
use running::{Errors, Log, Scores, Threshold, Way};

/// Measure place recognition on laser logs: accuracy, candidates, seconds, words and index
///
/// Regenerates the sections of docs/results/recognition.md. Needs POSECUT_SHARED_DATA (the logs in radish/), the release programs and
/// `cargo build --release -p posecut-recognize --examples`.
#[derive(Args)]
pub(crate) struct Recognition {
    /// Keep candidates with at least these agreements, beside the default of posecut-recognize
    #[arg(long, num_args = 1.., default_values_t = [0.45, 0.7])]
    agreements: Vec<f64>,
    /// Keep candidates with at least these scores, in further runs
    #[arg(long, num_args = 1.., default_values_t = [0.3, 0.5])]
    scores: Vec<f64>,
    /// Measure the index with at least these numbers of keyframes
    #[arg(long, num_args = 1.., default_values_t = [10_000, 40_000])]
    keyframes: Vec<usize>,
    /// Write into the sections of this document [default: docs/results/recognition.md]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// The log with measured relations comes first.
const LOGS: [&str; 3] = ["aces", "intel", "mit-csail"];

/// What was measured of a log.
struct Found {
    name: &'static str,
    errors: Vec<(String, Errors)>,
    thresholds: Vec<Vec<String>>,
    seconds: Vec<String>,
    scores: Scores,
    index: Vec<running::IndexTimes>,
}

impl Recognition {
    pub(crate) fn run(self) -> anyhow::Result<Verdict> {
        let document = self.output.clone().unwrap_or_else(|| root().join("docs/results/recognition.md"));
        let data = shared_data()?.join("radish");
        let folder = tempfile::tempdir()?;
        let mut found = Vec::new();
        for name in LOGS {
            eprintln!("{name}");
            let log = Log { name, file: data.join(format!("{name}.clf.bz2")), folder: folder.path() };
            let relations = data.join(format!("{name}.relations"));
            found.push(self.measured(name, &log, relations.is_file().then_some(relations))?);
        }
        let machine = Machine::here();
        let measured = format!(
            "Measured {} on {} cores, {:.0} GB, {}.",
            today()?,
            machine.cores,
            machine.gigabytes,
            machine.model
        );
        for (section, text) in [("measured", measured)].into_iter().chain(sections(found)) {
            replace(&document, section, &text)?;
        }
        Ok(Verdict::Holds)
    }

    fn measured(&self, name: &'static str, log: &Log, relations: Option<PathBuf>) -> anyhow::Result<Found> {
        let (graph, trajectory, ingest) = log.ingest(true)?;
        let agreements = self.agreements.iter().copied().map(Threshold::Agreement);
        let thresholds = agreements.chain(self.scores.iter().copied().map(Threshold::Score));
        let thresholds = std::iter::once(Threshold::Default).chain(thresholds);
        let ways: Vec<Way> =
            thresholds.map(|threshold| log.way(&graph, threshold)).collect::<anyhow::Result<_>>()?;
        let first = &ways[0];
        // By relations if there are any, else the map at the default threshold.
        let map = match &relations {
            Some(relations) => Map::of_truth(&log.by_relations(&graph, &trajectory, relations)?)?,
            None => Map::read(&first.optimised)?,
        };
        let mut errors = Vec::new();
        if let Some(relations) = relations {
            let (odometry, along, _) = log.ingest(false)?;
            errors.push(("odometry".to_owned(), running::relations(&odometry, &along, &relations)?));
            errors.push(("scan matching".to_owned(), running::relations(&graph, &trajectory, &relations)?));
            for way in &ways {
                let title = format!("whole pipeline, {}", way.threshold.title());
                errors.push((title, running::relations(&way.optimised, &trajectory, &relations)?));
            }
        }
        let (all, _) = log.recognize(&graph, Threshold::Agreement(0.0))?;
        let (duration, scans) = running::duration(&trajectory)?;
        Ok(Found {
            name,
            errors,
            thresholds: tables::thresholds(name, &ways, &map),
            seconds: tables::seconds(name, scans, duration, ingest, first),
            scores: running::scores(&all, &map)?,
            index: self
                .keyframes
                .iter()
                .map(|&count| running::index(&graph, count))
                .collect::<anyhow::Result<_>>()?,
        })
    }
}

/// The sections of the document.
fn sections(found: Vec<Found>) -> [(&'static str, String); 7] {
    let mut rows: [Vec<Vec<String>>; 3] = [const { Vec::new() }; 3];
    let mut errors = Vec::new();
    let mut index = Vec::new();
    let mut scores = Vec::new();
    for log in found {
        rows[0].extend(log.thresholds);
        rows[1].push(log.seconds);
        rows[2].extend(tables::words(log.name, &log.scores));
        errors.extend(log.errors);
        index.extend(log.index.into_iter().map(|times| (log.name, times)));
        scores.push((log.name, log.scores));
    }
    let calibration = |of: fn(&Scores) -> &[Scored]| {
        let logs: Vec<(&str, &[Scored])> = scores.iter().map(|(name, scores)| (*name, of(scores))).collect();
        tables::calibration(&logs)
    };
    [
        ("relations", tables::relations(&errors)),
        ("thresholds", tables::thresholds_table(&rows[0])),
        ("seconds", tables::seconds_table(&rows[1])),
        ("words", tables::words_table(&rows[2])),
        ("appearance", calibration(|scores| &scores.appearance)),
        ("score", calibration(|scores| &scores.correct)),
        ("index", tables::index(&index)),
    ]
}

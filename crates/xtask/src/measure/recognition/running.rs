//! Runs the programs on a log, from the log to an optimised map.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use anyhow::{Context as _, bail};
use serde::Deserialize;
use serde_json::Value;
use xtask::workspace::{program, programs_folder};

use super::graph::{Landmark, Map, landmarks};
use super::ranking::Scored;
use crate::process::{Ended, Measured, measure, must, shown};

/// The programs after posecut-ingest, in their order.
pub(super) const STAGES: [&str; 4] = ["ingest", "recognize", "verify", "optimize"];

/// CPU and wall seconds of a process.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Seconds {
    pub(super) cpu: f64,
    pub(super) wall: f64,
}

impl Seconds {
    pub(super) fn and(self, other: Self) -> Self {
        Self { cpu: self.cpu + other.cpu, wall: self.wall + other.wall }
    }
}

/// A log, and where its results go.
pub(super) struct Log<'a> {
    pub(super) name: &'a str,
    pub(super) file: PathBuf,
    pub(super) folder: &'a Path,
}

/// What the way from recognition to a map found at one threshold.
pub(super) struct Way {
    pub(super) threshold: Threshold,
    /// The edges after verification.
    pub(super) edges: Vec<Landmark>,
    pub(super) optimised: PathBuf,
    /// Of posecut-recognize, posecut-verify and posecut-optimize.
    pub(super) seconds: [Seconds; 3],
}

/// Which candidates posecut-recognize keeps.
#[derive(Clone, Copy, Debug)]
pub(super) enum Threshold {
    /// Its own choice.
    Default,
    Agreement(f64),
    Score(f64),
}

impl Threshold {
    /// The option of posecut-recognize.
    fn option(self) -> Option<String> {
        match self {
            Self::Default => None,
            Self::Agreement(least) => Some(format!("--least-agreement={least}")),
            Self::Score(least) => Some(format!("--least-score={least}")),
        }
    }

    /// What tables call it.
    pub(super) fn title(self) -> String {
        self.option().map_or_else(|| "default".to_owned(), |option| format!("`{}`", option.replace('=', " ")))
    }
}

/// Errors of relations: mean and standard deviation in metres and radians.
pub(super) struct Errors {
    pub(super) compared: u64,
    pub(super) translation: [f64; 2],
    pub(super) rotation: [f64; 2],
}

fn run(command: &mut Command) -> anyhow::Result<Seconds> {
    match measure(command, Duration::from_mins(20))? {
        Ended::Done(Measured { cpu, wall, .. }) => Ok(Seconds { cpu, wall }),
        Ended::Failed(said) => bail!("{}: {said}", shown(command)),
        Ended::OutOfTime => bail!("{}: is not done after 20 minutes", shown(command)),
    }
}

impl Log<'_> {
    fn path(&self, end: &str) -> PathBuf {
        self.folder.join(format!("{}.{end}", self.name))
    }

    /// The graph with odometry and scans, and the trajectory along the scans.
    pub(super) fn ingest(&self, scan_matching: bool) -> anyhow::Result<(PathBuf, PathBuf, Seconds)> {
        let name = if scan_matching { "matched" } else { "odometry" };
        let (graph, trajectory) = (self.path(&format!("{name}.jsonl")), self.path(&format!("{name}.tum")));
        let mut command = Command::new(program("ingest"));
        command.arg("-q").arg(&self.file).args(scan_matching.then_some("--scan-matching"));
        command.arg("--trajectory").arg(&trajectory).arg("-o").arg(&graph);
        let seconds = run(&mut command)?;
        Ok((graph, trajectory, seconds))
    }

    fn of_threshold(&self, threshold: Threshold, end: &str) -> PathBuf {
        self.path(&format!("{}.{end}", threshold.option().as_deref().unwrap_or("default")))
    }

    /// The graph with the truth that relations give.
    pub(super) fn by_relations(
        &self,
        graph: &Path,
        trajectory: &Path,
        relations: &Path,
    ) -> anyhow::Result<PathBuf> {
        let labelled = self.path("labelled.jsonl");
        let mut command = Command::new(program("label"));
        command.arg("-q").arg(graph).arg("--relations").arg(relations).arg("--trajectory").arg(trajectory);
        must(command.arg("-o").arg(&labelled))?;
        Ok(labelled)
    }

    /// Recognition alone.
    pub(super) fn recognize(&self, graph: &Path, threshold: Threshold) -> anyhow::Result<(PathBuf, Seconds)> {
        let recognized = self.of_threshold(threshold, "recognized.jsonl");
        let mut command = Command::new(program("recognize"));
        command.arg("-q").arg(graph).arg("-o").arg(&recognized);
        command.args(threshold.option());
        let seconds = run(&mut command)?;
        Ok((recognized, seconds))
    }

    /// From the graph of posecut-ingest to an optimised map.
    pub(super) fn way(&self, graph: &Path, threshold: Threshold) -> anyhow::Result<Way> {
        let (recognized, recognition) = self.recognize(graph, threshold)?;
        let verified = self.of_threshold(threshold, "verified.jsonl");
        let optimised = self.of_threshold(threshold, "optimised.jsonl");
        let stage = |name: &str, from: &Path, to: &Path| {
            run(Command::new(program(name)).arg("-q").arg(from).arg("-o").arg(to))
        };
        let verification = stage("verify", &recognized, &verified)?;
        let optimisation = stage("optimize", &verified, &optimised)?;
        let edges = landmarks(&verified)?;
        Ok(Way { threshold, edges, optimised, seconds: [recognition, verification, optimisation] })
    }
}

/// Errors of an estimate against relations that somebody measured.
pub(super) fn relations(graph: &Path, trajectory: &Path, relations: &Path) -> anyhow::Result<Errors> {
    let mut command = Command::new(program("evaluate"));
    command.arg("-q").arg(graph).arg("--relations").arg(relations).arg("--trajectory").arg(trajectory);
    let result: Value = serde_json::from_slice(&must(&mut command)?)?;
    let number = |summary: &str, of: &str| {
        let value = result["relations"][summary][of].as_f64();
        value.with_context(|| format!("{}: gives no {summary}", shown(&command)))
    };
    let both = |summary: &str| Ok::<_, anyhow::Error>([number(summary, "mean")?, number(summary, "std")?]);
    let compared = result["relations"]["compared"].as_u64().unwrap_or_default();
    Ok(Errors { compared, translation: both("translation_m")?, rotation: both("rotation_rad")? })
}

/// Seconds from the first to the last scan of a trajectory, and the number of scans.
pub(super) fn duration(trajectory: &Path) -> anyhow::Result<(f64, usize)> {
    let text = std::fs::read_to_string(trajectory)?;
    let times = text.lines().filter_map(|line| line.split_whitespace().next()?.parse::<f64>().ok());
    let times: Vec<f64> = times.collect();
    let first = times.iter().copied().fold(f64::INFINITY, f64::min);
    let last = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Ok((last - first, times.len()))
}

/// Scores of candidates: of words, and of matched scans.
pub(super) struct Scores {
    /// FAB-MAP's probability, for being the same place.
    pub(super) appearance: Vec<Scored>,
    /// The similarity by tf-idf, for being the same place.
    pub(super) similarity: Vec<Scored>,
    /// The probability from the agreement of scans, for being the same place.
    pub(super) place: Vec<Scored>,
    /// The same, for being a correct measurement.
    pub(super) correct: Vec<Scored>,
}

/// The scores of all candidates of a graph that posecut-recognize wrote.
pub(super) fn scores(recognized: &Path, map: &Map) -> anyhow::Result<Scores> {
    #[derive(Deserialize)]
    struct Line {
        edge: u64,
        similarity: f64,
    }
    let example = programs_folder().join("examples/similarity");
    let output = must(Command::new(example).arg(recognized))?;
    let lines =
        csv::Reader::from_reader(&output[..]).into_deserialize::<Line>().collect::<Result<Vec<_>, _>>()?;
    let edges = landmarks(recognized)?;
    let same =
        lines.len() == edges.len() && lines.iter().zip(&edges).all(|(line, edge)| line.edge == edge.id);
    if !same {
        bail!("{}: the similarities are of other edges", recognized.display());
    }
    let place =
        |score: fn(&Landmark) -> f64| edges.iter().map(|edge| (score(edge), map.same_place(edge))).collect();
    Ok(Scores {
        appearance: place(|edge| edge.appearance),
        similarity: lines
            .iter()
            .zip(&edges)
            .map(|(line, edge)| (line.similarity, map.same_place(edge)))
            .collect(),
        place: place(|edge| edge.score),
        correct: edges.iter().map(|edge| (edge.score, map.correct(edge))).collect(),
    })
}

/// Times of the index of places.
#[derive(Deserialize)]
pub(super) struct IndexTimes {
    pub(super) keyframes: u64,
    pub(super) describe: f64,
    pub(super) build: f64,
    pub(super) query: f64,
    pub(super) linear: f64,
    /// The share of the answers of the search that the index finds.
    pub(super) found: f64,
}

/// Times the index on a graph that is repeated until it has this many keyframes.
pub(super) fn index(graph: &Path, keyframes: usize) -> anyhow::Result<IndexTimes> {
    let example = programs_folder().join("examples/index");
    Ok(serde_json::from_slice(&must(Command::new(example).arg(graph).arg(keyframes.to_string()))?)?)
}

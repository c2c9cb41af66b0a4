//! Recognition as a stage: reads scans and words, and adds landmark edges.

use std::path::PathBuf;

use anyhow::bail;
use posecut_geometry::LieGroup;
use posecut_geometry::covariance::pack_upper_triangle;
use posecut_graph::{Dimension, Edge, EdgeKind, InputDigest, PoseGraph};
use posecut_scan::Scans;
use posecut_stage::{Context, Doubt, Examples, GraphStage, Phase, Place, Source, counted, digest, info};
use serde::Serialize;

use crate::recognition::{Candidate, Recognition, recognize, recognize_in_space};
use crate::scan_context::ScanContext;
use crate::velodyne::{Spatial, read_folders};
use crate::{Settings, Words};

/// The options of the program.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
#[group(skip)]
pub struct Options {
    /// Read the scans from this file and not from the graph: lines with records of kind `scan`, as posecut-ingest --scans writes them
    #[arg(long, value_name = "FILE", help_heading = "Sensor data")]
    #[serde(skip)]
    pub scans: Option<Source>,

    /// Recognise places by these words and not by those of the scans: a CSV file with the columns node and word; without scans, landmark edges have no measurement
    #[arg(long, value_name = "FILE", help_heading = "Sensor data")]
    #[serde(skip)]
    pub words: Option<Source>,

    /// Recognise places by the three-dimensional scans in this folder: files UTIME.bin as in NCLT's velodyne_sync; one folder for each session of the graph.
    ///
    /// Candidates are measured with the planar scans of the graph, or without them with a slice of the three-dimensional ones.
    #[arg(long, value_name = "FOLDER", help_heading = "Sensor data")]
    #[serde(skip)]
    pub velodyne: Vec<PathBuf>,

    /// How places are described and candidates chosen.
    #[command(flatten)]
    #[serde(flatten)]
    pub settings: Settings,
}

impl GraphStage for Options {
    const NAME: &'static str = "recognize";
    const ABOUT: &'static str = "Find landmark edges by place recognition and scan matching";
    const PLACE: Place = Place(Phase::Graphs, 27);
    const DOUBTS: &'static [Doubt] = &[Doubt::NothingKept];
    const EXAMPLES: Examples = Examples(&[
        (
            "From a laser log to a map",
            "posecut ingest robot.log --scan-matching | posecut recognize \\\n    | posecut verify | posecut optimize | posecut map -o map.png",
        ),
        (
            "Recognise places by the words of an image front end",
            "posecut recognize session.jsonl --words words.csv -o candidates.jsonl",
        ),
    ]);

    fn seed(&self) -> Option<u64> {
        Some(self.settings.seed)
    }

    fn check(&self) -> anyhow::Result<()> {
        self.settings.check()
    }

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        if graph.header.dimension != Dimension::Two {
            bail!(
                "the graph has dimension 3, but laser scans are matched in the plane; use a graph of dimension 2"
            );
        }
        let file = self.scans.as_ref().map(|source| context.read_bytes(source, "scans")).transpose()?;
        let mut scans = Scans::of_file_or_graph(file.as_ref(), graph)?;
        let contexts = self.contexts(graph, &mut scans, context)?;
        let words = match &self.words {
            Some(source) => {
                let (file, bytes) = context.read_bytes(source, "words")?;
                Some(Words::read(graph, &file, &bytes[..])?)
            }
            None => None,
        };
        if scans.is_empty() && words.is_none() {
            bail!(
                "the graph has no scans to recognise places by; write them with posecut-ingest, or name a file with --scans or --words, or a folder with --velodyne"
            );
        }
        let found = match contexts {
            Some(contexts) => recognize_in_space(graph, &scans, contexts, words, &self.settings)?,
            None => recognize(graph, &scans, words, &self.settings)?,
        };
        report(&found, graph.nodes.len(), scans.len(), context);
        add(graph, found.candidates);
        Ok(())
    }
}

impl Options {
    /// The contexts of three-dimensional scans, if the options name any. Without planar scans their slices become the scans.
    fn contexts(
        &self,
        graph: &PoseGraph,
        scans: &mut Scans,
        context: &mut Context,
    ) -> anyhow::Result<Option<Vec<Option<ScanContext>>>> {
        if self.velodyne.is_empty() {
            return Ok(None);
        }
        let Spatial { scans: spatial, digests } =
            read_folders(&self.velodyne, graph, &self.settings.context, digest)?;
        let sha256 = digest(digests.as_bytes());
        context.inputs.push(InputDigest { name: "velodyne".to_owned(), sha256 });
        info!(
            "{} at {}",
            counted(spatial.iter().flatten().count(), "three-dimensional scan"),
            counted(graph.nodes.len(), "keyframe")
        );
        if scans.is_empty() {
            let slices = graph.nodes.iter().zip(&spatial);
            *scans =
                slices.filter_map(|(node, scan)| Some((node.id, scan.as_ref()?.slice.clone()))).collect();
        }
        Ok(Some(spatial.into_iter().map(|scan| scan.map(|scan| scan.context)).collect()))
    }
}

fn report(found: &Recognition, keyframes: usize, scans: usize, context: &mut Context) {
    info!(
        "{} from {keyframes} keyframes: {} proposed, {} without a match, {} with too little agreement{}",
        counted(found.candidates.len(), "landmark edge"),
        found.proposed,
        found.unmatched,
        found.disagreeing,
        match found.improbable {
            0 => String::new(),
            improbable => format!(", {improbable} with too low a score"),
        }
    );
    let statistics = &mut context.statistics;
    statistics.note("scans", scans);
    statistics.note("proposed", found.proposed);
    statistics.note("unmatched", found.unmatched);
    statistics.note("disagreeing", found.disagreeing);
    statistics.note("improbable", found.improbable);
    statistics.note("landmark_edges", found.candidates.len());
    if found.proposed > 0 && found.candidates.is_empty() {
        context.doubt(
            Doubt::NothingKept,
            "no candidate was kept; lower --least-agreement or --least-score, or check the scans and the odometry",
        );
    }
}

/// Adds landmark edges for candidates, after the edges that the graph has.
fn add(graph: &mut PoseGraph, candidates: Vec<Candidate>) {
    let first = graph.edges.iter().map(|edge| edge.id + 1).max().unwrap_or(0);
    for (number, candidate) in candidates.into_iter().enumerate() {
        let (from, to) = (graph.nodes[candidate.from].id, graph.nodes[candidate.to].id);
        let mut edge = Edge::new(EdgeKind::Landmark, first + number as u64, from, to);
        edge.score = Some(candidate.probability());
        edge.extra.insert("appearance".to_owned(), candidate.appearance.into());
        if let Some(measurement) = candidate.measurement {
            edge.measurement = Some(measurement.pose.components());
            edge.information = Some(pack_upper_triangle(&measurement.information));
            edge.extra.insert("agreement".to_owned(), measurement.agreement.into());
        }
        graph.edges.push(edge);
    }
}

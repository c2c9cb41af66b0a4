//! Labelling as a stage: reads the source of labels that the options name.

use anyhow::Context as _;
use posecut_evaluate::relations::{RelationErrors, Track, relations};
use posecut_evaluate::summary::Summary;
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_stage::{Context, Examples, GraphStage, Phase, Place, Source, counted, info};
use serde::Serialize;

use crate::ground_truth::{self, Comparison, GroundTruth};
use crate::{all_correct, check_labels, pairs, table, zero_measurements};

/// The measurements of landmark edges in the output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Measurements {
    /// Those of the input
    Keep,
    /// The identity ("the same place"), as from a recogniser without geometry
    Zero,
}

/// Where labels come from. Files are in the history by their digests.
#[derive(Clone, Debug, PartialEq, Serialize, clap::Args)]
#[group(skip)]
pub struct Options {
    /// Read labels from this CSV file: columns i, j and inlier (1 or 0); with a column kind, only from its rows `loop`
    #[arg(long, value_name = "FILE", group = "source", help_heading = "Source of labels")]
    #[serde(skip)]
    pub labels: Option<Source>,

    /// Read the correct edges from this list, one pair of node ids per line in either order; all others are incorrect
    #[arg(long, value_name = "FILE", group = "source", help_heading = "Source of labels")]
    #[serde(skip)]
    pub correct_pairs: Option<Source>,

    /// Label every landmark edge correct
    #[arg(long, group = "source", help_heading = "Source of labels")]
    pub all_correct: bool,

    /// Compare edges with the ground truth in this file: a pose graph (JSON Lines) with the same node ids or, with --times, a CSV file of time, x, y, heading
    #[arg(long, value_name = "FILE", group = "source", help_heading = "Source of labels")]
    #[serde(skip)]
    pub ground_truth: Option<Source>,

    /// Compare edges with the map that the measured relations in this file make of the odometry: lines `t1 t2 x y z roll pitch yaw`
    #[arg(
        long,
        value_name = "FILE",
        group = "source",
        requires = "trajectory",
        help_heading = "Source of labels"
    )]
    #[serde(skip)]
    pub relations: Option<Source>,

    /// Compare edges with the poses of the nodes, and move these poses to the ground truth
    #[arg(long, group = "source", help_heading = "Source of labels")]
    pub vertices: bool,

    /// Read the times of the nodes for --ground-truth from this file, seconds, one per line, node 0 first
    #[arg(long, value_name = "FILE", requires = "ground_truth", help_heading = "Ground truth")]
    #[serde(skip)]
    pub times: Option<Source>,

    /// Read the poses of the log at each scan for --relations from this file: the --trajectory of posecut-ingest
    #[arg(long, value_name = "FILE", requires = "relations", help_heading = "Ground truth")]
    #[serde(skip)]
    pub trajectory: Option<Source>,

    /// How edges are compared with the ground truth.
    #[command(flatten)]
    #[serde(flatten)]
    pub comparison: Comparison,

    /// Choose the measurements of landmark edges in the output
    #[arg(long, value_enum, default_value_t = Measurements::Keep)]
    pub measurements: Measurements,
}

impl GraphStage for Options {
    const NAME: &'static str = "label";
    const ABOUT: &'static str = "Write which landmark edges of a graph are correct";
    const PLACE: Place = Place(Phase::Graphs, 50);
    const EXAMPLES: Examples = Examples(&[
        (
            "Read the labels from a table with the columns i, j and inlier",
            "posecut label graph.jsonl --labels labels.csv -o labelled.jsonl",
        ),
        (
            "Call edges within 1 m and 10 degrees of the ground truth correct",
            "posecut label graph.jsonl --ground-truth truth.jsonl \\\n    --tolerance-translation 1 --tolerance-rotation 10 -o labelled.jsonl",
        ),
        (
            "Label candidates of a laser log by relations that people measured",
            "posecut ingest robot.log --scan-matching --trajectory robot.tum \\\n    | posecut recognize | posecut label --relations robot.relations \\\n        --trajectory robot.tum -o labelled.jsonl",
        ),
    ]);

    fn run(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<()> {
        self.comparison.check()?;
        if let Some(source) = &self.labels {
            let (file, bytes) = context.read_bytes(source, "labels")?;
            table::apply(graph, &file, &table::read(&file, &bytes)?)?;
        } else if let Some(source) = &self.correct_pairs {
            let (file, bytes) = context.read_bytes(source, "correct pairs")?;
            pairs::apply(graph, &file, &pairs::read(&file, &bytes)?)?;
        } else if self.all_correct {
            all_correct(graph);
        } else if let Some(truth) = self.truth(graph, context)? {
            ground_truth::apply(graph, &truth, &self.comparison)?;
        } else {
            check_labels(graph)?;
        }
        if self.measurements == Measurements::Zero {
            zero_measurements(graph);
        }
        let all = graph.edges_of(EdgeKind::Landmark).count();
        let correct =
            graph.edges_of(EdgeKind::Landmark).filter(|edge| edge.truth_correct() == Some(true)).count();
        info!("{correct} correct and {} incorrect landmark edges", all - correct);
        context.statistics.note("landmark_edges", all);
        context.statistics.note("correct", correct);
        context.statistics.note("incorrect", all - correct);
        Ok(())
    }
}

impl Options {
    /// The ground truth that the options name; `None` if they name none.
    fn truth(&self, graph: &mut PoseGraph, context: &mut Context) -> anyhow::Result<Option<GroundTruth>> {
        if self.vertices {
            return Ok(Some(GroundTruth::taken_from(graph)));
        }
        if let Some((source, trajectory)) = self.relations.as_ref().zip(self.trajectory.as_ref()) {
            let (file, bytes) = context.read_bytes(source, "relations")?;
            let (track_file, track) = context.read_bytes(trajectory, "trajectory")?;
            let (known, track) = (relations(&file, &bytes[..])?, Track::read(&track_file, &track[..])?);
            let (truth, errors) = GroundTruth::of_relations(&file, graph, &known, &track)?;
            report(&errors, context);
            return Ok(Some(truth));
        }
        let Some(source) = &self.ground_truth else { return Ok(None) };
        if let Some(times) = &self.times {
            let (file, bytes) = context.read_bytes(source, "ground truth")?;
            let (times_file, times) = context.read_bytes(times, "times")?;
            let longest_silence = self.comparison.longest_silence;
            return GroundTruth::of_track((&file, &bytes), (&times_file, &times), longest_silence).map(Some);
        }
        let name = source.to_string();
        let truth = context.read_graph(source, "ground truth").with_context(|| {
            format!("{name}: cannot be used as ground truth; convert it to JSON Lines with posecut-convert, or name --times for a CSV file of time, x, y, heading")
        })?;
        GroundTruth::of_graph(&name, &truth, graph.header.dimension).map(Some)
    }
}

/// How far the map that relations make is from them.
fn report(errors: &RelationErrors, context: &mut Context) {
    let mean = |summary: &Option<Summary>| summary.as_ref().map_or(0.0, |summary| summary.mean);
    info!(
        "the map of {} and the odometry is off them by {:.3} m and {:.2} degrees on average",
        counted(errors.compared, "relation"),
        mean(&errors.translation_m),
        mean(&errors.rotation_rad).to_degrees()
    );
    context.statistics.note("relations", errors);
}

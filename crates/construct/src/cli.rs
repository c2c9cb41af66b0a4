//! The command line of `posecut-construct`: builds a multi-session pose graph from session graphs.

use std::process::ExitCode;

use crate::{Construction, Landmarks, MatchMeasurement, Options, construct, read_matches};
use clap::Parser;
use posecut_stage::{
    CommonArguments, Context, Doubt, Examples, Identity, Outcome, Phase, Place, Source, counted, info,
    run_with_doubts,
};

#[derive(Parser)]
struct Command {
    /// Read these session graphs (JSON Lines, may be compressed): a single one is split into two experiences, several are joined
    #[arg(value_name = "SESSION", default_value = "-")]
    sessions: Vec<Source>,

    /// Take landmark edges from this list of a place recogniser instead of ground truth: CSV of frame i, frame j, score
    #[arg(long, value_name = "FILE", help_heading = "Landmark edges from a list")]
    matches: Option<Source>,

    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    (
        "Split a session into two experiences, and add 10 % incorrect edges",
        "posecut ingest 2012-01-22/ |\n    posecut construct --incorrect-rate 0.1 -o graph.jsonl",
    ),
    ("Join two sessions", "posecut construct 2012-01-22.jsonl 2012-03-31.jsonl -o graph.jsonl"),
    (
        "Take landmark edges from a place recogniser",
        "posecut construct session.jsonl --matches matches.csv -o graph.jsonl",
    ),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "construct",
        version: env!("CARGO_PKG_VERSION"),
        about: "Build a multi-session pose graph with correct and incorrect landmark edges",
        place: Place(Phase::Graphs, 30),
        examples: EXAMPLES,
    };
    run_with_doubts::<Command>(
        identity,
        &[Doubt::CovarianceInvented],
        |command| &command.common,
        |command, context| {
            let graphs = command
                .sessions
                .iter()
                .map(|source| context.read_graph(source, "session"))
                .collect::<anyhow::Result<Vec<_>>>()?;
            let landmarks = match &command.matches {
                None => Landmarks::Truth,
                Some(source) => {
                    let (file, bytes) = context.read_bytes(source, "matches")?;
                    Landmarks::Matches { matches: read_matches(&file, &bytes)?, file }
                }
            };
            let construction = construct(graphs, &landmarks, &command.options)?;
            report(&construction, &landmarks, &command.options, context);
            let mut graph = construction.graph;
            doubt(&landmarks, &command.options, context);
            context.record_provenance(&mut graph, &command.options, Some(command.options.seed))?;
            context.write_graph(&graph)?;
            Ok(Outcome::Done)
        },
    )
}

/// Reports the edges on standard error and in the statistics.
fn report(construction: &Construction, landmarks: &Landmarks, options: &Options, context: &mut Context) {
    let Construction { graph, chains, counts } = construction;
    let statistics = &mut context.statistics;
    if let Some(chains) = chains {
        statistics.note("odometry_gaps", options.odometry_gaps);
        statistics.note("chains", chains);
    }
    statistics.note("sessions", graph.sessions());
    statistics.note("nodes", graph.nodes.len());
    statistics.note("nodes_with_truth", counts.nodes_with_truth);
    statistics.note("landmark_edges", counts.landmark_edges);
    statistics.note("correct_edges", counts.correct_edges);
    statistics.note("incorrect_edges", counts.incorrect_edges);
    match landmarks {
        Landmarks::Truth => {
            info!(
                "added {} correct and {} incorrect landmark edges",
                counts.correct_edges, counts.incorrect_edges
            );
            statistics.note("incorrect_kind", options.incorrect_kind);
        }
        Landmarks::Matches { .. } => info!(
            "added {} from the list: {} correct and {} incorrect by ground truth",
            counted(counts.landmark_edges, "landmark edge"),
            counts.correct_edges,
            counts.incorrect_edges
        ),
    }
    if let Some(groups) = counts.incorrect_groups {
        statistics.note("incorrect_groups", groups);
    }
}

/// Records a doubt if edges are made from a list of matches, because a list has no covariances.
fn doubt(landmarks: &Landmarks, options: &Options, context: &mut Context) {
    let Landmarks::Matches { matches, .. } = landmarks else { return };
    if options.match_measurement == MatchMeasurement::Identity && !matches.is_empty() {
        context.doubt(
            Doubt::CovarianceInvented,
            format!(
                "the list of matches has no covariances, so the standard deviations of {} are invented ({} m, {} rad); set \
                 --landmark-sigma-translation and --landmark-sigma-rotation to the spacing of viewpoints",
                counted(matches.len(), "landmark edge"),
                options.landmark_sigma_translation,
                options.landmark_sigma_rotation
            ),
        );
    }
}

//! `posecut-construct`: builds a multi-session pose graph from session graphs.

use std::process::ExitCode;

use clap::Parser;
use posecut_construct::{Landmarks, MatchMeasurement, Options, construct, read_matches};
use posecut_stage::{
    CommonArguments, Context, Doubt, Identity, Outcome, Phase, Place, Source, run_with_doubts,
};

#[derive(Parser)]
struct Command {
    /// Session graphs (JSON Lines, may be compressed); one is split into two experiences, several are joined
    #[arg(value_name = "SESSION", default_value = "-")]
    sessions: Vec<Source>,

    /// Take landmark edges from a place recogniser's list instead: CSV, frame i, frame j, score
    #[arg(long, value_name = "FILE", help_heading = "Landmark edges from a list")]
    matches: Option<Source>,

    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

fn main() -> ExitCode {
    let identity = Identity {
        name: "construct",
        version: env!("CARGO_PKG_VERSION"),
        about: "Build a multi-session pose graph with correct and incorrect landmark edges",
        place: Place(Phase::Graphs, 30),
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
            let (mut graph, statistics) = construct(graphs, &landmarks, &command.options)?;
            context.statistics = statistics;
            doubt(&landmarks, &command.options, context);
            context.record_provenance(&mut graph, &command.options, Some(command.options.seed))?;
            context.write_graph(&graph)?;
            Ok(Outcome::Done)
        },
    )
}

/// Records a doubt if edges are made from a list of matches, because a list has no covariances.
fn doubt(landmarks: &Landmarks, options: &Options, context: &mut Context) {
    let Landmarks::Matches { matches, .. } = landmarks else { return };
    if options.match_measurement == MatchMeasurement::Identity && !matches.is_empty() {
        context.doubt(
            Doubt::CovarianceInvented,
            format!(
                "the list of matches has no covariances, so {} the identity within {} m and {} rad; set \
                 --landmark-sigma-translation and --landmark-sigma-rotation to the spacing of viewpoints",
                if matches.len() == 1 {
                    "1 edge claims".to_owned()
                } else {
                    format!("{} edges claim", matches.len())
                },
                options.landmark_sigma_translation,
                options.landmark_sigma_rotation
            ),
        );
    }
}

//! The command line of `posecut-evaluate`: compares an estimate with a reference and writes one JSON result.

use std::process::ExitCode;

use crate::alignment::Freedom;
use crate::edges::EdgeScores;
use crate::result::AlignmentUsed;
use crate::{Options, Scope, evaluate};
use clap::Parser;
use posecut_graph::StageDoubt;
use posecut_stage::{
    CommonArguments, Doubt, Examples, Identity, Outcome, Phase, Place, Source, counted, info, run_with_doubts,
};

#[derive(Parser)]
struct Command {
    /// Evaluate this optimised pose graph; `-` is standard input
    #[arg(value_name = "ESTIMATE", default_value = "-")]
    estimate: Source,

    /// Compare with this graph, matched by node ids [default: the estimate's own ground truth]
    #[arg(long, value_name = "FILE")]
    reference: Option<Source>,

    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    ("Compare with the ground truth in the graph", "posecut evaluate map.jsonl -o map.result.json"),
    (
        "Compare with another graph, and label the result for tables",
        "posecut evaluate map.jsonl --reference reference.jsonl \\\n    --label method=pcm --label session=2012-01-22 -o map.result.json",
    ),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "evaluate",
        version: env!("CARGO_PKG_VERSION"),
        about: "Compare an estimate with a reference: RMSE, ATE, RPE, and precision and recall of landmark edges",
        place: Place(Phase::Results, 10),
        examples: EXAMPLES,
    };
    run_with_doubts::<Command>(
        identity,
        &[Doubt::PartsNotConnected],
        |command| &command.common,
        |command, context| {
            let estimate = context.read_graph(&command.estimate, "estimate")?;
            let reference = command
                .reference
                .as_ref()
                .map(|source| context.read_graph(source, "reference"))
                .transpose()?;
            let mut result = evaluate(&estimate, reference.as_ref(), &command.options)?;
            info!(
                "RMSE {:.3} m over {} {}",
                result.rmse,
                counted(result.poses, "pose"),
                alignment(&result.alignment)
            );
            if let Some(edges) = &result.edges {
                info!("{}", scores(edges));
            }
            let aligned = result.alignment.found.len();
            if result.alignment.scope == Scope::PerComponent && aligned > 1 {
                context.doubt(
                    Doubt::PartsNotConnected,
                    format!(
                        "the {aligned} components of the reference are aligned separately, so the RMSE does not measure their \
                         relative poses; use --scope joint to include them"
                    ),
                );
            }
            let own = |doubt: &str| StageDoubt { stage: identity.name.to_owned(), doubt: doubt.to_owned() };
            result.doubts.extend(context.doubts().into_iter().map(own));
            context.statistics.note("rmse", result.rmse);
            context.statistics.note("poses", result.poses);
            context.statistics.note("edges", &result.edges);
            let mut bytes = serde_json::to_vec_pretty(&result)?;
            bytes.push(b'\n');
            context.write_bytes(&bytes)?;
            Ok(Outcome::Done)
        },
    )
}

/// Precision and recall of the landmark edges in words.
fn scores(edges: &EdgeScores) -> String {
    let share =
        |share: Option<f64>| share.map_or_else(|| "undefined".to_owned(), |share| format!("{share:.4}"));
    format!(
        "precision {}, recall {}: {} of {} in use incorrect, {} of {} rejected",
        share(edges.precision),
        share(edges.recall),
        edges.false_positive,
        counted(edges.true_positive + edges.false_positive, "landmark edge"),
        edges.false_negative,
        counted(edges.true_positive + edges.false_negative, "correct edge"),
    )
}

/// The alignment in words.
fn alignment(used: &AlignmentUsed) -> String {
    match used.freedom {
        Freedom::None => "without alignment".to_owned(),
        freedom => format!("after {} alignment of {}", freedom.name(), used.scope.name()),
    }
}

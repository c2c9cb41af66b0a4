//! `posecut-evaluate`: compares an estimate with a reference and writes one JSON result.

use std::process::ExitCode;

use clap::Parser;
use posecut_evaluate::{Options, Scope, evaluate};
use posecut_graph::StageDoubt;
use posecut_stage::{CommonArguments, Doubt, Identity, Outcome, Phase, Place, Source, info, run_with_doubts};

#[derive(Parser)]
struct Command {
    /// The estimate: an optimised pose graph; `-` is standard input
    #[arg(value_name = "ESTIMATE", default_value = "-")]
    estimate: Source,

    /// The reference graph, matched by node ids; the estimate's own ground truth unless given
    #[arg(long, value_name = "FILE")]
    reference: Option<Source>,

    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

fn main() -> ExitCode {
    let identity = Identity {
        name: "evaluate",
        version: env!("CARGO_PKG_VERSION"),
        about: "Compare an estimate with a reference: RMSE, ATE, RPE, and precision and recall of landmark edges",
        place: Place(Phase::Results, 10),
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
                "RMSE {:.3} m over {} poses after {} alignment of {}",
                result.rmse,
                result.poses,
                result.alignment.freedom.name(),
                result.alignment.scope.name()
            );
            let aligned = result.alignment.found.len();
            if result.alignment.scope == Scope::PerComponent && aligned > 1 {
                context.doubt(
                    Doubt::PartsNotConnected,
                    format!(
                        "the {aligned} components of the reference are aligned each by itself, so the RMSE says nothing of their \
                         relative poses; --scope joint counts those, too"
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

//! The program: cuts pose graphs.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use posecut_stage::{CommonArguments, Context, GraphStage as _, Identity, Outcome, Source};

use crate::Solution;
use crate::stage::StageOptions;

#[derive(Parser)]
struct Command {
    /// The pose graph to read (JSON Lines, may be compressed); `-` is standard input
    #[arg(value_name = "INPUT", default_value = "-")]
    input: Source,

    #[command(flatten)]
    stage: StageOptions,

    /// Write a certificate of the lower bound, which `posecut-partition verify` checks
    #[arg(long, value_name = "FILE", help_heading = "Proof")]
    certificate: Option<PathBuf>,

    /// Leave rejected edges out of the output instead of marking them
    #[arg(long, help_heading = "Output")]
    drop_rejected: bool,

    #[command(flatten)]
    common: CommonArguments,
}

/// The program's `main`.
pub fn main() -> ExitCode {
    let identity =
        Identity { name: StageOptions::NAME, version: env!("CARGO_PKG_VERSION"), about: StageOptions::ABOUT };
    posecut_stage::run_with_doubts::<Command>(
        identity,
        StageOptions::DOUBTS,
        |command| &command.common,
        |command, context| {
            command.check(context)?;
            command.cut_pose_graph(context)
        },
    )
}

impl Command {
    /// Refuses options without a meaning, and files that would overwrite each other.
    fn check(&self, context: &Context) -> anyhow::Result<()> {
        self.stage.check()?;
        self.certificate.as_ref().map_or(Ok(()), |file| context.check_further_output("--certificate", file))
    }

    fn cut_pose_graph(&self, context: &mut Context) -> anyhow::Result<Outcome> {
        let mut graph = context.read_graph(&self.input, "graph")?;
        let solution = self.stage.cut(&mut graph, self.certificate.is_some(), context)?;
        context.record_provenance(&mut graph, &self.stage, self.stage.seed())?;
        if self.drop_rejected {
            graph.drop_rejected();
        }
        self.write_certificate(&solution)?;
        context.write_graph(&graph)?;
        Ok(Outcome::Done)
    }

    fn write_certificate(&self, solution: &Solution) -> anyhow::Result<()> {
        let (Some(path), Some(certificate)) = (&self.certificate, &solution.certificate) else {
            return Ok(());
        };
        posecut_stage::write_atomically(path, |mut writer| Ok(certificate.write(&mut writer)?))
    }
}

//! `posecut-ingest`: builds the pose graph of a session from NCLT's files.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::Parser;
use posecut_ingest::{Options, SessionFiles, ingest};
use posecut_stage::{CommonArguments, Doubt, Identity, Outcome, Phase, Place, run_with_doubts};

#[derive(Parser)]
struct Command {
    /// The session: a directory with NCLT's CSV files, or its DATE_sen.tar.gz
    #[arg(value_name = "SESSION")]
    session: PathBuf,

    /// The ground-truth file, if it does not lie in the directory or beside the archive
    #[arg(long, value_name = "FILE")]
    ground_truth: Option<PathBuf>,

    /// A folder of images named UTIME.tiff that set the keyframes; lb3/Cam5 in the directory is found by itself
    #[arg(long, value_name = "DIRECTORY")]
    images: Option<PathBuf>,

    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

fn main() -> ExitCode {
    let identity = Identity {
        name: "ingest",
        version: env!("CARGO_PKG_VERSION"),
        about: "Read an NCLT session and write its pose graph: keyframes, odometry, ground truth",
        place: Place(Phase::Graphs, 20),
    };
    run_with_doubts::<Command>(
        identity,
        &[Doubt::CovarianceInvented],
        |command| &command.common,
        |command, context| {
            command.options.check()?;
            let mut files = SessionFiles::find(
                &command.session,
                command.ground_truth.as_deref(),
                command.images.as_deref(),
            )?;
            let progress = context.progress(0, "reading");
            let mut ingested = ingest(&mut files, &command.options, &progress)?;
            context.inputs.extend_from_slice(files.digests());
            context.statistics = ingested.statistics;
            if let Some((translation, rotation)) = ingested.invented {
                context.doubt(
                    Doubt::CovarianceInvented,
                    format!(
                        "the covariances of odometry are not all given, so each step claims {translation} m and {rotation} rad; \
                         give both --sigma-translation and --sigma-rotation, or put odometry_cov.csv beside the odometry"
                    ),
                );
            }
            context.record_provenance(&mut ingested.graph, &command.options, None)?;
            context.write_graph(&ingested.graph)?;
            Ok(Outcome::Done)
        },
    )
}

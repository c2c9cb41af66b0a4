//! The command line of `posecut-ingest`: builds the pose graph of a session from NCLT's files or from a CARMEN log.

mod log;
mod matches;
mod scans;
mod sensors;

use std::path::PathBuf;
use std::process::ExitCode;

use crate::{Event, Options, SessionFiles, Summary, ingest};
use clap::Parser;
use posecut_carmen::LogOptions;
use posecut_graph::InputDigest;
use posecut_stage::{
    CommonArguments, Doubt, Examples, Identity, Outcome, Phase, Place, Statistics, counted, digest, info,
    run_with_doubts, warn,
};

#[derive(Parser)]
struct Command {
    /// Read this session: a directory with NCLT's CSV files, its DATE_sen.tar.gz, or a CARMEN log (plain, gzip, bzip2; `-` is standard input)
    #[arg(value_name = "SESSION")]
    session: PathBuf,

    /// Read ground truth from this file [default: groundtruth_DATE.csv in the directory or beside the archive]
    #[arg(long, value_name = "FILE")]
    ground_truth: Option<PathBuf>,

    /// Take the times of keyframes from the names of the images in this directory, UTIME.tiff [default: lb3/Cam5 in the session, if there is one]
    #[arg(long, value_name = "DIRECTORY")]
    images: Option<PathBuf>,

    /// Read laser scans from this file [default: hokuyo_30m.bin in the session, if there is one]
    #[arg(long, value_name = "FILE", help_heading = "Laser scans")]
    hokuyo: Option<PathBuf>,

    /// Write the scans to this file, one record a line, instead of into the graph
    #[arg(long, value_name = "FILE", help_heading = "Laser scans")]
    scans: Option<PathBuf>,

    /// Refine the odometry by matching the scans of successive keyframes
    #[arg(long, help_heading = "Laser scans")]
    scan_matching: bool,

    /// Write the pose of the robot at each scan of the log to this file, in the format of the TUM benchmark
    #[arg(long, value_name = "FILE", help_heading = "CARMEN logs")]
    trajectory: Option<PathBuf>,

    #[command(flatten)]
    log: LogOptions,

    #[command(flatten)]
    options: Options,

    #[command(flatten)]
    common: CommonArguments,
}

const EXAMPLES: Examples = Examples(&[
    ("Read a session", "posecut ingest 2012-01-22/ -o session.jsonl"),
    (
        "Correct wheels that over-read by 7 %",
        "posecut ingest 2012-01-22/ --wheel-scale 0.93 -o session.jsonl",
    ),
    ("Read a laser log, and match its scans", "posecut ingest robot.log --scan-matching -o session.jsonl"),
]);

/// The `main` of the program.
pub fn main() -> ExitCode {
    let identity = Identity {
        name: "ingest",
        version: env!("CARGO_PKG_VERSION"),
        about: "Read an NCLT session or a CARMEN log and write its pose graph: keyframes, odometry, ground truth, scans",
        place: Place(Phase::Graphs, 20),
        examples: EXAMPLES,
    };
    run_with_doubts::<Command>(
        identity,
        &[Doubt::CovarianceInvented],
        |command| &command.common,
        |command, context| {
            command.options.check()?;
            command.log.check()?;
            if log::is_log(&command.session)? {
                return log::run(command, context);
            }
            log::refuse_options_of_logs(command)?;
            let mut files = SessionFiles::find(
                &command.session,
                command.ground_truth.as_deref(),
                command.images.as_deref(),
            )?;
            if let Some(path) = &command.hokuyo {
                files.set_hokuyo(path);
            }
            sensors::check(command, &files, context)?;
            let progress = context.progress(0, "reading");
            let mut inputs = Vec::new();
            let options = Options { scan_matching: command.scan_matching, ..command.options.clone() };
            let mut ingested = ingest(&mut files, &options, &mut |event| match event {
                Event::Opened { name, bytes } => {
                    progress.inc_length(bytes.len() as u64);
                    inputs.push(InputDigest { name: name.to_owned(), sha256: digest(bytes) });
                }
                Event::Parsed(bytes) => progress.inc(bytes),
                Event::Chosen(choice) => info!("{choice}"),
                Event::Warning(warning) => warn!("{warning}"),
            })?;
            progress.finish_and_clear();
            context.inputs.extend(inputs);
            note(&ingested.summary, &mut context.statistics);
            if command.options.gps.is_some() {
                let (priors, keyframes) = (ingested.graph.priors.len(), ingested.graph.nodes.len());
                context.statistics.note("priors", priors);
                info!("{} of positions from GPS, {keyframes} keyframes", counted(priors, "prior"));
            }
            if let Some((translation, rotation)) = ingested.invented {
                context.doubt(
                    Doubt::CovarianceInvented,
                    format!(
                        "the covariances of odometry are not all given, so each step has standard deviations of {translation} m and \
                         {rotation} rad; set both --sigma-translation and --sigma-rotation, or put odometry_cov.csv beside the \
                         odometry"
                    ),
                );
            }
            context.record_provenance(&mut ingested.graph, &options, None)?;
            sensors::write(command, &mut ingested, context)?;
            context.write_graph(&ingested.graph)?;
            Ok(Outcome::Done)
        },
    )
}

fn note(summary: &Summary, statistics: &mut Statistics) {
    statistics.note("session", &summary.session);
    statistics.note("keyframes", summary.keyframes);
    statistics.note("keyframes_with_truth", summary.keyframes_with_truth);
    statistics.note("path_length_m", summary.path_length);
    statistics.note("true_path_length_m", summary.true_path_length);
    statistics.note("duration_s", summary.duration);
    statistics.note("odometry", summary.odometry);
    statistics.note("heading", summary.heading);
    statistics.note("odometry_dropped_rows", summary.odometry_dropped_rows);
    statistics.note("gaps", summary.gaps);
    statistics.note("truth_gaps", summary.truth_gaps);
    statistics.note("covariance", summary.covariance.name());
    statistics.note("true_distance_factor", summary.distance_factor.map(|factor| factor.median));
    statistics.note("step_error_forward_m", summary.step_errors.forward);
    statistics.note("step_error_sideways_m", summary.step_errors.sideways);
    statistics.note("step_error_heading_rad", summary.step_errors.heading);
    statistics.note("nees", &summary.nees);
    statistics.note("dropped_rows", summary.dropped_rows);
    statistics.note("frozen_truth_rows", summary.frozen_truth_rows);
    statistics.note("clock", summary.clock);
}

//! Sessions that are CARMEN logs.

use std::io::Read as _;
use std::path::Path;

use anyhow::bail;
use posecut_carmen::{
    Log, LogError, LogOptions, Session, Summary, expanded, looks_like_log, session_name, trajectory,
    write_trajectory,
};
use posecut_stage::{Context, Outcome, Source, Statistics, counted, info, open_file, warn, write_atomically};
use serde::Serialize;
use serde_json::{Map, Value};

use super::Command;
use super::matches;
use super::scans::{self, SCANS};
use crate::Options;

/// The option that names the file of the poses at all scans.
const TRAJECTORY: &str = "--trajectory";

/// Bytes by which a log is recognised.
const START: u64 = 1 << 16;

/// Whether a session is a log: standard input, or a file that begins as one.
pub(super) fn is_log(session: &Path) -> anyhow::Result<bool> {
    if session == Path::new("-") {
        return Ok(true);
    }
    if !session.is_file() {
        return Ok(false);
    }
    let mut start = Vec::new();
    // A file that cannot be decompressed is none; its reader reports the error.
    let read = open_file(session)?.take(START).read_to_end(&mut start);
    Ok(read.is_ok() && looks_like_log(&start))
}

/// Reads a log and writes its graph.
pub(super) fn run(command: &Command, context: &mut Context) -> anyhow::Result<Outcome> {
    let place = command.session.display().to_string();
    let options = Options { name: None, ..command.options.clone() };
    refuse_changed(&options, &Options::DEFAULT, &format!("{place} is a CARMEN log"), "NCLT sessions")?;
    if command.hokuyo.is_some() {
        bail!("--hokuyo applies to NCLT sessions, but {place} is a CARMEN log; omit the option");
    }
    for (option, path) in [(SCANS, &command.scans), (TRAJECTORY, &command.trajectory)] {
        if let Some(path) = path {
            context.check_further_output(option, path)?;
        }
    }
    let standard = command.session == Path::new("-");
    let source = if standard { Source::Standard } else { Source::File(command.session.clone()) };
    let (place, bytes) = context.read_bytes(&source, "log")?;
    let content = expanded(bytes).map_err(|error| LogError::Compression { place: place.clone(), error })?;
    let options = LogOptions { scan_matching: command.scan_matching, ..command.log.clone() };
    let log = Log::read(&place, &content[..], &options)?;
    drop(content);
    warn_of_repairs(&place, &log);
    let file = command.session.file_name().map(|name| name.to_string_lossy().into_owned());
    let name = command
        .options
        .name
        .clone()
        .unwrap_or_else(|| session_name(file.as_deref().filter(|_| !standard).unwrap_or_default()));
    let mut session = Session::of_log(&place, &name, &log, &options)?;
    note(&session.summary, &mut context.statistics);
    report(&session.summary);
    context.record_provenance(&mut session.graph, &options, None)?;
    if let Some(path) = &command.trajectory {
        let poses = trajectory(&log, &session, &options);
        write_atomically(path, |writer| Ok(write_trajectory(&poses, writer)?))?;
    }
    let Session { mut graph, scans, .. } = session;
    let nodes: Vec<u64> = graph.nodes.iter().map(|node| node.id).collect();
    scans::write(command.scans.as_deref(), nodes.into_iter().zip(&scans), &mut graph)?;
    context.write_graph(&graph)?;
    Ok(Outcome::Done)
}

/// Refuses options of logs for a session that is none.
pub(super) fn refuse_options_of_logs(command: &Command) -> anyhow::Result<()> {
    let what = format!("{} is not a CARMEN log", command.session.display());
    if command.trajectory.is_some() {
        bail!("{TRAJECTORY} applies to CARMEN logs, but {what}; omit the option");
    }
    refuse_changed(&command.log, &LogOptions::DEFAULT, &what, "CARMEN logs")
}

/// Refuses options that are not at their defaults.
fn refuse_changed<O: Serialize>(given: &O, default: &O, what: &str, kind: &str) -> anyhow::Result<()> {
    let fields = |options: &O| -> anyhow::Result<Map<String, Value>> {
        Ok(serde_json::to_value(options)?.as_object().cloned().unwrap_or_default())
    };
    let default = fields(default)?;
    if let Some((name, _)) = fields(given)?.iter().find(|(name, value)| default.get(*name) != Some(value)) {
        bail!("--{} applies to {kind}, but {what}; omit the option", name.replace('_', "-"));
    }
    Ok(())
}

fn warn_of_repairs(place: &str, log: &Log) {
    let repairs = log.repairs;
    if repairs.out_of_order > 0 {
        warn!(
            "{place}: {} earlier than the one before by less than 10 s; the order of the lines is kept",
            counted(repairs.out_of_order, "scan")
        );
    }
    for (count, what, why) in [
        (repairs.other_beams, "scan", "another number of beams than the first one"),
        (
            repairs.unused_scans,
            "scan",
            "without odometry, or of a second scanner: RAWLASER1, RLASER, ROBOTLASER2",
        ),
        (repairs.meaningless_ranges, "range", "NaN, infinite or negative: taken as no return"),
    ] {
        if count > 0 {
            warn!("{place}: skipped {} ({why})", counted(count, what));
        }
    }
    if repairs.empty_scans > 0 {
        warn!("{place}: {} without any return below --max-range", counted(repairs.empty_scans, "scan"));
    }
    if repairs.moving_scanner {
        warn!(
            "{place}: the poses of the scanner are at no fixed position on the robot, so they are probably corrected ones; they are \
             ignored, and the scanner is taken to be at the robot's origin"
        );
    }
}

fn report(summary: &Summary) {
    info!(
        "{} of {}, {:.1} m by odometry in {:.0} s",
        counted(summary.keyframes, "keyframe"),
        counted(summary.scans, "scan"),
        summary.path_length_m,
        summary.duration_s
    );
    matches::report(summary.scan_matching.as_ref());
}

fn note(summary: &Summary, statistics: &mut Statistics) {
    statistics.note("session", &summary.session);
    statistics.note("scans", summary.scans);
    statistics.note("keyframes", summary.keyframes);
    statistics.note("keyframes_with_truth", summary.keyframes_with_truth);
    statistics.note("path_length_m", summary.path_length_m);
    statistics.note("turning_rad", summary.turning_rad);
    statistics.note("duration_s", summary.duration_s);
    statistics.note("beams", summary.beams);
    statistics.note("returns", summary.returns);
    statistics.note("repairs", summary.repairs);
    matches::note(summary.scan_matching.as_ref(), statistics);
}

//! Laser scans of NCLT sessions: where they are written.

use anyhow::bail;
use posecut_stage::{Context, counted, info};

use super::Command;
use super::matches;
use super::scans::{self, SCANS};
use crate::{FileKind, Ingested, SessionFiles};

/// Refuses a file for scans that the session does not have, or that would replace another file.
pub(super) fn check(command: &Command, files: &SessionFiles, context: &mut Context) -> anyhow::Result<()> {
    if let Some(path) = files.path(FileKind::Hokuyo) {
        context.note_read(path);
    }
    let Some(path) = &command.scans else { return Ok(()) };
    if !files.has(FileKind::Hokuyo) {
        bail!(
            "{SCANS} writes laser scans, but {} has no hokuyo_30m.bin; name it with --hokuyo, or omit the option",
            files.place()
        );
    }
    context.check_further_output(SCANS, path)
}

/// Writes the scans into the graph, or to the file that the options name.
pub(super) fn write(command: &Command, ingested: &mut Ingested, context: &mut Context) -> anyhow::Result<()> {
    let Some(laser) = &ingested.laser else { return Ok(()) };
    info!(
        "{} at {}",
        counted(laser.scans.len(), "laser scan"),
        counted(ingested.graph.nodes.len(), "keyframe")
    );
    matches::report(ingested.comparison.as_ref());
    let statistics = &mut context.statistics;
    matches::note(ingested.comparison.as_ref(), statistics);
    statistics.note("scans", laser.scans.len());
    statistics.note("scans_in_file", laser.in_file);
    statistics.note("scans_out_of_order", laser.out_of_order);
    statistics.note("keyframes_without_scan", laser.keyframes_without);
    statistics.note("empty_scans", laser.empty);
    if let Some(path) = &command.scans {
        // Once more, now that the files of the session have been read.
        context.check_further_output(SCANS, path)?;
    }
    let scans = laser.scans.iter().map(|(node, scan)| (*node, scan));
    scans::write(command.scans.as_deref(), scans, &mut ingested.graph)
}

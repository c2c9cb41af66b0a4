//! Where the scans of a session are written: into its graph, or to a file of their own.

use std::path::Path;

use anyhow::Context as _;
use posecut_graph::PoseGraph;
use posecut_scan::{LaserScan, put_into_graph, write_records};
use posecut_stage::write_atomically;

/// The option that names the file of the scans.
pub(super) const SCANS: &str = "--scans";

/// Writes scans with their nodes to the file that the options name, else into the graph.
pub(super) fn write<'a>(
    file: Option<&Path>,
    scans: impl Iterator<Item = (u64, &'a LaserScan)>,
    graph: &mut PoseGraph,
) -> anyhow::Result<()> {
    match file {
        Some(path) => write_atomically(path, |writer| Ok(write_records(scans, writer)?)),
        None => put_into_graph(scans, graph).context("a scan cannot be written as JSON"),
    }
}

//! Where the records of scans go: into their graph, or to a file of their own.

use std::io::Write;

use posecut_graph::PoseGraph;

use crate::LaserScan;

/// Puts scans with their nodes into a graph, as records after its priors. O(beams).
///
/// # Errors
///
/// A number of a scan is not finite.
pub fn put_into_graph<'a>(
    scans: impl IntoIterator<Item = (u64, &'a LaserScan)>,
    graph: &mut PoseGraph,
) -> serde_json::Result<()> {
    for (node, scan) in scans {
        graph.unknown.push(scan.record(node)?);
    }
    Ok(())
}

/// Writes the records of scans with their nodes, one a line. O(beams).
///
/// # Errors
///
/// As for [`put_into_graph`], or the writer fails.
pub fn write_records<'a>(
    scans: impl IntoIterator<Item = (u64, &'a LaserScan)>,
    writer: &mut dyn Write,
) -> std::io::Result<()> {
    for (node, scan) in scans {
        writeln!(writer, "{}", scan.record(node)?)?;
    }
    Ok(())
}

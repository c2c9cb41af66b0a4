//! Laser odometry of a session: the steps between keyframes, refined by matching their scans.

use std::collections::BTreeMap;

use posecut_geometry::covariance::pack_upper_triangle;
use posecut_geometry::{LieGroup, SE2};
use posecut_graph::PoseGraph;
use posecut_matching::laser_odometry::{Comparison, Measured, by_matching};
use posecut_scan::LaserScan;

use crate::{FileKind, IngestError, Laser, Options, SessionFiles};

/// Refuses what cannot be matched.
pub(crate) fn check(files: &SessionFiles, options: &Options) -> Result<(), IngestError> {
    let refuse = |problem: &str, remedy: &str| Err(IngestError::session(files.place(), problem, remedy));
    if options.scan_matching && !files.has(FileKind::Hokuyo) {
        return refuse(
            "it has no hokuyo_30m.bin, so --scan-matching has no scans to match",
            "name the file with --hokuyo, or omit the option",
        );
    }
    if options.scan_matching && options.dimension != 2 {
        return refuse(
            "--scan-matching matches planar scans, and --dimension 3 asks for poses in space",
            "omit one of the options",
        );
    }
    Ok(())
}

/// Replaces the steps whose scans match, and the poses that follow from all steps. Steps without a match stay as they are.
/// O(keyframes * beams).
pub(crate) fn refine(graph: &mut PoseGraph, laser: &Laser) -> Result<Comparison, IngestError> {
    let unusable = |error: posecut_graph::UnusableField| {
        IngestError::session("odometry", error.to_string(), "set --sigma-translation and --sigma-rotation")
    };
    let scans: BTreeMap<u64, &LaserScan> = laser.scans.iter().map(|(node, scan)| (*node, scan)).collect();
    let scans: Vec<Option<&LaserScan>> =
        graph.nodes.iter().map(|node| scans.get(&node.id).copied()).collect();
    let mut odometry = Vec::with_capacity(graph.edges.len());
    for edge in &graph.edges {
        // Each edge of a session has both, so that steps, edges and pairs of nodes are in one order.
        let measured = graph.measurement::<SE2, 3>(edge).map_err(unusable)?;
        odometry.extend(measured.map(|(motion, information)| Measured { motion, information }));
    }
    let (measured, comparison) = by_matching(&odometry, &scans);
    let mut pose = SE2::identity();
    for (index, (step, before)) in measured.iter().zip(&odometry).enumerate() {
        if step != before {
            let edge = &mut graph.edges[index];
            edge.measurement = Some(step.motion.components());
            edge.information = Some(pack_upper_triangle(&step.information));
            edge.noise = None;
        }
        pose = pose.compose(&step.motion);
        graph.nodes[index + 1].pose = Some(pose.components());
    }
    Ok(comparison)
}

//! Poses of nodes, and their positions as the page stores them.

use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{Dimension, PoseGraph};
use serde::Serialize;

use crate::encode::{bits, series};

/// A drawn position is exact to this part of the extent, or better.
const PARTS: f64 = 1e5;

/// Positions beyond this many steps from the origin are drawn there: scripts count exactly to this.
const FARTHEST: f64 = (1_u64 << 51) as f64;

/// The poses of a graph's nodes, world from body; in the plane, z is 0.
pub(crate) fn poses(graph: &PoseGraph) -> Vec<Option<SE3>> {
    let dimension = graph.header.dimension;
    graph.nodes.iter().map(|node| dimension.spatial(node.pose.as_deref()?)).collect()
}

/// The poses that another graph has for the nodes of this one, by id.
pub(crate) fn poses_in(graph: &PoseGraph, other: &PoseGraph) -> Vec<Option<SE3>> {
    let found = poses(other);
    graph.nodes.iter().map(|node| found[other.node_index(node.id)?]).collect()
}

/// The step that positions are rounded to, metres: a power of ten, at most a hundred-thousandth of the extent of the
/// middle nine tenths of the nodes and at least 0.1 mm.
pub(crate) fn step(maps: &[&[Option<SE3>]]) -> f64 {
    let mut extent = 0.0_f64;
    for poses in maps {
        for axis in 0..3 {
            let mut values: Vec<f64> = poses.iter().flatten().map(|pose| pose.translation()[axis]).collect();
            if values.is_empty() {
                continue;
            }
            let (low, high) = (values.len() / 20, values.len() - 1 - values.len() / 20);
            let (_, low, _) = values.select_nth_unstable_by(low, f64::total_cmp);
            let low = *low;
            let (_, high, _) = values.select_nth_unstable_by(high, f64::total_cmp);
            extent = extent.max(*high - low);
        }
    }
    10_f64.powf((extent / PARTS).log10().floor()).clamp(1e-4, 1e12)
}

/// Positions of all nodes, in their order, in steps.
#[derive(Debug, Serialize)]
pub(crate) struct Positions {
    /// Which nodes have a position; absent if all have one. The others repeat the last position.
    placed: Option<String>,
    x: String,
    y: String,
    /// Absent in the plane.
    z: Option<String>,
}

impl Positions {
    /// `None` if no node has a position.
    pub(crate) fn of(poses: &[Option<SE3>], dimension: Dimension, step: f64) -> Option<Self> {
        poses.iter().flatten().next()?;
        let axis = |axis: usize| {
            let mut last = 0.0;
            let value = poses.iter().map(|pose| {
                last = pose.map_or(last, |pose| pose.translation()[axis]);
                last.clamp(-FARTHEST * step, FARTHEST * step)
            });
            series(value, step)
        };
        Some(Self {
            placed: poses.iter().any(Option::is_none).then(|| bits(poses.iter().map(Option::is_some))),
            x: axis(0),
            y: axis(1),
            z: (dimension == Dimension::Three).then(|| axis(2)),
        })
    }
}

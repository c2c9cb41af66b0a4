//! How far poses moved.

use posecut_graph::PoseGraph;
use serde::Serialize;

/// Distances between the poses of two graphs with the same nodes, metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Movement {
    /// The median distance.
    pub median: f64,
    /// The largest distance.
    pub most: f64,
}

impl Movement {
    /// Compares the positions of the nodes. The optimiser keeps the first node of a component at its pose, so both graphs have one
    /// frame. `None` if a node has no pose in one of them, or there are no nodes.
    pub fn between(before: &PoseGraph, after: &PoseGraph) -> Option<Self> {
        let axes = before.header.dimension.number() as usize;
        let pairs = before.nodes.iter().zip(&after.nodes);
        let mut distances = pairs
            .map(|(one, other)| {
                let (one, other) = (one.pose.as_ref()?, other.pose.as_ref()?);
                let squares = one.iter().zip(other).take(axes).map(|(a, b)| (a - b).powi(2));
                Some(squares.sum::<f64>().sqrt())
            })
            .collect::<Option<Vec<f64>>>()?;
        distances.sort_by(f64::total_cmp);
        Some(Self { median: *distances.get(distances.len() / 2)?, most: *distances.last()? })
    }
}

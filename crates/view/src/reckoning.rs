//! Dead reckoning: the poses that odometry alone gives.

use std::collections::VecDeque;

use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{EdgeKind, PoseGraph};

/// Poses by odometry alone.
pub(crate) struct Reckoning {
    /// The poses of all nodes.
    pub(crate) poses: Vec<Option<SE3>>,
    /// How many chains of odometry there are, a lone node included.
    pub(crate) chains: usize,
}

/// Composes odometry from the first node of each chain, which keeps its pose, or the origin without one. `None` without odometry
/// that has measurements. Linear time.
pub(crate) fn dead_reckoning(graph: &PoseGraph, poses: &[Option<SE3>]) -> Option<Reckoning> {
    let dimension = graph.header.dimension;
    let mut neighbours: Vec<Vec<(usize, SE3)>> = vec![Vec::new(); graph.nodes.len()];
    let mut any = false;
    for edge in graph.edges_of(EdgeKind::Odometry).filter(|edge| edge.in_use()) {
        let motion = edge.measurement.as_deref().and_then(|components| dimension.spatial(components));
        if let (Some((from, to)), Some(motion)) = (graph.ends(edge), motion) {
            neighbours[from].push((to, motion));
            neighbours[to].push((from, motion.inverse()));
            any = true;
        }
    }
    if !any {
        return None;
    }
    let mut found: Vec<Option<SE3>> = vec![None; graph.nodes.len()];
    let mut waiting = VecDeque::new();
    let mut chains = 0;
    for start in 0..found.len() {
        if found[start].is_some() {
            continue;
        }
        found[start] = Some(poses[start].unwrap_or_else(SE3::identity));
        waiting.push_back(start);
        chains += 1;
        while let Some(node) = waiting.pop_front() {
            let Some(pose) = found[node] else { continue };
            for &(next, motion) in &neighbours[node] {
                if found[next].is_none() {
                    found[next] = Some(pose.compose(&motion));
                    waiting.push_back(next);
                }
            }
        }
    }
    Some(Reckoning { poses: found, chains })
}

/// Whether two sets of poses look the same: no position differs by more than `tolerance`, metres.
pub(crate) fn same(one: &[Option<SE3>], other: &[Option<SE3>], tolerance: f64) -> bool {
    one.iter().zip(other).all(|(one, other)| match (one, other) {
        (Some(one), Some(other)) => {
            let (one, other) = (one.translation(), other.translation());
            (0..3).all(|axis| (one[axis] - other[axis]).abs() <= tolerance)
        }
        (None, None) => true,
        _ => false,
    })
}

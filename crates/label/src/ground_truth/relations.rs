//! The map that measured relations make of a graph's odometry.
//!
//! A relation says where the robot at one time was in the frame of the robot at another (Kuemmerle et al., *On measuring the accuracy of SLAM
//! algorithms*, Autonomous Robots 27, 2009). With the poses `P` of the log at every scan, a relation `d` between times `t` and `u` near the
//! keyframes `a` and `b` is the edge
//!
//! ```text
//! Z_ab = (P_a^-1 P_t) d (P_b^-1 P_u)^-1
//! ```
//!
//! The map has the least squares of these edges and of the odometry. No candidate has a part in it.

use anyhow::bail;
use nalgebra::{SMatrix, SVector};
use posecut_evaluate::relations::{Relation, RelationErrors, Track, relation_errors};
use posecut_geometry::{LieGroup as _, SE3, translations};
use posecut_graph::{PoseGraph, for_dimension};
use posecut_optimize::{Edge, EdgeKind, Options, PoseGroup, Problem, optimize, pose_graph};

/// The standard deviations that relations are taken to have, metres and radians: about what maps of a log differ from them.
const DEVIATION: [f64; 2] = [0.05, 0.01];

/// The poses of the nodes in the map, in their order, and how far the map is from the relations. O(nodes + edges + relations log nodes), and
/// the optimisation.
///
/// # Errors
///
/// No relation is between two keyframes, or an odometry edge cannot be used.
pub(super) fn poses(
    graph: &PoseGraph,
    relations: &[Relation],
    track: &Track,
) -> anyhow::Result<(Vec<SE3>, RelationErrors)> {
    let edges = between_keyframes(graph, relations, track);
    if edges.is_empty() {
        bail!(
            "none of the {} relations is between two different keyframes with a time; use the relations and the trajectory of this log",
            relations.len()
        );
    }
    let mut map = graph.clone();
    for_dimension!(graph.header.dimension, |G, DOF| optimise::<G, DOF>(&mut map, &edges))?;
    let dimension = graph.header.dimension;
    let poses = map.nodes.iter().map(|node| dimension.spatial(&node.pose_or_identity(dimension)));
    let poses = poses.map(|pose| pose.unwrap_or_else(SE3::identity)).collect();
    Ok((poses, relation_errors(&map, relations, Some(track), 0.0)))
}

/// Relations as motions between the keyframes that are nearest in time, by the positions of their nodes. Those between one keyframe
/// and itself, and those at times without a pose, are left out.
fn between_keyframes(graph: &PoseGraph, relations: &[Relation], track: &Track) -> Vec<(usize, usize, SE3)> {
    let mut keyframes: Vec<(i64, usize)> =
        graph.nodes.iter().enumerate().filter_map(|(at, node)| Some((node.utime?, at))).collect();
    keyframes.sort_unstable();
    // The nearest keyframe, and the pose at the time in its frame.
    let near = |time: i64| {
        let after = keyframes.partition_point(|(stamp, _)| *stamp < time);
        let around = keyframes[after.saturating_sub(1)..].iter().take(2);
        let (stamp, node) = around.min_by_key(|(stamp, _)| stamp.abs_diff(time))?;
        Some((*node, track.at(*stamp)?.between(&track.at(time)?)))
    };
    let edge = |relation: &Relation| {
        let [from, to] = relation.times.map(near);
        let ((from, first), (to, last)) = from.zip(to)?;
        (from != to).then(|| (from, to, first.compose(&relation.motion).compose(&last.inverse())))
    };
    relations.iter().filter_map(edge).collect()
}

/// Moves the nodes to the least squares of odometry and relations.
fn optimise<G: PoseGroup<DOF>, const DOF: usize>(
    graph: &mut PoseGraph,
    relations: &[(usize, usize, SE3)],
) -> anyhow::Result<()> {
    let mut edges = pose_graph::edges::<G, DOF>(graph)?.edges;
    edges.retain(|edge| edge.kind == EdgeKind::Odometry);
    let deviation = SVector::<f64, DOF>::from_fn(|row, _| DEVIATION[usize::from(row >= translations(DOF))]);
    let information = SMatrix::from_diagonal(&deviation.map(|deviation| deviation.powi(-2)));
    for (from, to, motion) in relations {
        let components = graph.header.dimension.components(motion);
        let Some(motion) = G::from_components(&components) else { continue };
        edges.push(Edge::new(*from, *to, motion, information, EdgeKind::Landmark));
    }
    let solution = optimize(&Problem::new(graph.poses::<G, DOF>()?, edges)?, &Options::default());
    for (node, pose) in graph.nodes.iter_mut().zip(&solution.poses) {
        node.pose = Some(pose.components());
    }
    Ok(())
}

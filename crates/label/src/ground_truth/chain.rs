//! The true poses of a graph; nodes without one get theirs from odometry.

use std::collections::{HashMap, VecDeque};

use posecut_geometry::{LieGroup as _, SE3};
use posecut_graph::{EdgeKind, PoseGraph};

/// The poses of a graph's nodes: the ground truth, else the pose, else a pose composed along odometry edges. In a chain
/// without any pose, the first node is at the origin. O(nodes + edges).
pub(super) fn poses(graph: &PoseGraph) -> HashMap<u64, SE3> {
    let dimension = graph.header.dimension;
    let mut neighbours: HashMap<u64, Vec<(u64, SE3)>> = HashMap::new();
    for edge in graph.edges_of(EdgeKind::Odometry) {
        let measured = edge.measurement.as_deref().and_then(|measured| dimension.spatial(measured));
        if let Some(step) = measured {
            neighbours.entry(edge.from).or_default().push((edge.to, step));
            neighbours.entry(edge.to).or_default().push((edge.from, step.inverse()));
        }
    }
    let mut poses: HashMap<u64, SE3> = graph
        .nodes
        .iter()
        .filter_map(|node| {
            let known = node.truth.as_ref().and_then(|truth| truth.pose.as_deref()).or(node.pose.as_deref());
            Some((node.id, dimension.spatial(known?)?))
        })
        .collect();
    let mut reached: VecDeque<u64> =
        graph.nodes.iter().map(|node| node.id).filter(|id| poses.contains_key(id)).collect();
    for start in graph.nodes.iter().map(|node| node.id) {
        // Nodes that odometry connects to known poses come first. Then each remaining chain gets an origin of its own.
        spread(&neighbours, &mut poses, &mut reached);
        if !poses.contains_key(&start) && neighbours.contains_key(&start) {
            poses.insert(start, SE3::identity());
            reached.push_back(start);
        }
    }
    spread(&neighbours, &mut poses, &mut reached);
    poses
}

fn spread(
    neighbours: &HashMap<u64, Vec<(u64, SE3)>>,
    poses: &mut HashMap<u64, SE3>,
    reached: &mut VecDeque<u64>,
) {
    while let Some(node) = reached.pop_front() {
        let pose = poses[&node];
        for (other, step) in neighbours.get(&node).into_iter().flatten() {
            if !poses.contains_key(other) {
                poses.insert(*other, pose.compose(step));
                reached.push_back(*other);
            }
        }
    }
}

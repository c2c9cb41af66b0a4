//! Splits one session into two experiences.

use std::collections::HashSet;

use posecut_geometry::LieGroup;
use posecut_graph::{Dimension, EdgeKind, Node, PoseGraph, for_dimension};

use crate::ConstructError;

/// Splits every session at its middle keyframe into the experiences `/a` and `/b`. The odometry edges across the cut
/// are removed, and the poses of each second half start at the origin again: only the landmark edges may determine its
/// pose in the frame of the first half.
pub fn split_at_middle(graph: &mut PoseGraph) -> Result<(), ConstructError> {
    let names: Vec<String> = graph.sessions().into_iter().map(str::to_owned).collect();
    let mut second_half: HashSet<u64> = HashSet::new();
    for name in names {
        let members: Vec<usize> = (0..graph.nodes.len())
            .filter(|&index| graph.nodes[index].session.as_deref() == Some(&name))
            .collect();
        if members.len() < 2 {
            return Err(ConstructError::Join {
                problem: format!(
                    "the session \"{name}\" has too few keyframes to be split: {} of at least 2",
                    members.len()
                ),
                remedy: "use a longer session, or --split none".to_owned(),
            });
        }
        let (first, second) = members.split_at(members.len() / 2);
        for &index in first {
            graph.nodes[index].session = Some(format!("{name}/a"));
        }
        let start = graph.nodes[second[0]].pose.clone();
        for &index in second {
            let node = &mut graph.nodes[index];
            node.session = Some(format!("{name}/b"));
            second_half.insert(node.id);
            restart(graph.header.dimension, start.as_deref(), node);
        }
    }
    graph.edges.retain(|edge| {
        edge.kind != EdgeKind::Odometry || second_half.contains(&edge.from) == second_half.contains(&edge.to)
    });
    for (index, edge) in graph.edges.iter_mut().enumerate() {
        edge.id = index as u64;
    }
    Ok(())
}

/// Expresses a node's pose in the frame of the start.
pub(crate) fn restart(dimension: Dimension, start: Option<&[f64]>, node: &mut Node) {
    fn relative<G: LieGroup<DOF>, const DOF: usize>(start: &[f64], pose: &[f64]) -> Option<Vec<f64>> {
        Some(G::from_components(start)?.between(&G::from_components(pose)?).components())
    }
    let (Some(start), Some(pose)) = (start, node.pose.as_deref()) else { return };
    node.pose = for_dimension!(dimension, |G, DOF| relative::<G, DOF>(start, pose));
}

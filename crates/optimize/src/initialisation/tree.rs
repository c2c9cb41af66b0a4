//! Poses composed along a spanning tree of the edges.

use std::collections::VecDeque;

use posecut_geometry::LieGroup;

use crate::model::problem::{Edge, EdgeKind};
use posecut_cholesky::Adjacency;
use posecut_graph::connectivity::Forest;

/// Composes measurements from the first node of every connected component, which keeps its pose from `poses`.
///
/// Edges name nodes of `poses`. The tree takes odometry edges first, in their order, so that chains stay whole. Then it joins
/// the chains by the other edges, in their order. It is traversed breadth first, in the order of the edges. Nodes without
/// edges keep their poses. Takes almost linear time.
pub fn spanning_tree<G: LieGroup<DOF>, const DOF: usize>(poses: &[G], edges: &[Edge<G, DOF>]) -> Vec<G> {
    spanning_tree_from(0, poses, edges)
}

/// [`spanning_tree`] in which the first `held` nodes all keep their poses; the other poses are composed from the nearest held
/// node along the tree.
pub(crate) fn spanning_tree_from<G: LieGroup<DOF>, const DOF: usize>(
    held: usize,
    poses: &[G],
    edges: &[Edge<G, DOF>],
) -> Vec<G> {
    let mut forest = Forest::new(poses.len());
    let mut tree: Vec<&Edge<G, DOF>> = Vec::with_capacity(poses.len());
    for kind in [EdgeKind::Odometry, EdgeKind::Landmark] {
        tree.extend(edges.iter().filter(|edge| edge.kind == kind && forest.join(edge.from, edge.to)));
    }
    let mut result = poses.to_vec();
    let mut visited = vec![false; poses.len()];
    // Most trees list their edges along the chains. From one node the paths are unique, so any order of composition gives the same poses.
    if held <= 1 && composed_in_order(&tree, &mut result, &mut visited) {
        return result;
    }
    visited.fill(false);
    visited[..held].fill(true);
    let arcs = tree.iter().enumerate().flat_map(|(index, edge)| [(edge.from, index), (edge.to, index)]);
    let neighbours = Adjacency::new(poses.len(), arcs);
    let mut queue: VecDeque<usize> = (0..held).collect();
    for first in 0..poses.len() {
        if !visited[first] {
            visited[first] = true;
            queue.push_back(first);
        }
        while let Some(node) = queue.pop_front() {
            for &index in neighbours.of(node) {
                let (next, step) = across(tree[index], node);
                if !visited[next] {
                    visited[next] = true;
                    result[next] = result[node].compose(&step);
                    queue.push_back(next);
                }
            }
        }
    }
    result
}

/// Composes the measurements of a tree's edges in their order, from the first node on. False at the first edge that does not continue what
/// is composed by then.
fn composed_in_order<G: LieGroup<DOF>, const DOF: usize>(
    tree: &[&Edge<G, DOF>],
    result: &mut [G],
    visited: &mut [bool],
) -> bool {
    if let Some(first) = visited.first_mut() {
        *first = true;
    }
    tree.iter().all(|edge| {
        let known = if visited[edge.from] { edge.from } else { edge.to };
        let continues = visited[known];
        if continues {
            let (next, step) = across(edge, known);
            visited[next] = true;
            result[next] = result[known].compose(&step);
        }
        continues
    })
}

/// The other end of an edge, and the measured way there from `node`.
fn across<G: LieGroup<DOF>, const DOF: usize>(edge: &Edge<G, DOF>, node: usize) -> (usize, G) {
    if edge.from == node { (edge.to, edge.measurement) } else { (edge.from, edge.measurement.inverse()) }
}

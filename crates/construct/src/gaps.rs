//! Makes sessions with interrupted odometry.

use std::collections::HashMap;

use posecut_graph::connectivity::Forest;
use posecut_graph::{EdgeKind, PoseGraph};
use posecut_random::random;
use rand::seq::SliceRandom as _;

use crate::ConstructError;
use crate::split::restart;

/// Removes odometry edges drawn at random, and returns the number of chains afterwards. Edges whose removal leaves a
/// node without odometry are removed last. The poses of each new chain start at the origin again, as in a split
/// session. O(nodes + edges).
pub fn cut_odometry(graph: &mut PoseGraph, wanted: usize, seed: u64) -> Result<usize, ConstructError> {
    let mut order: Vec<usize> =
        (0..graph.edges.len()).filter(|&index| graph.edges[index].kind == EdgeKind::Odometry).collect();
    if wanted > order.len() {
        return Err(ConstructError::TooFewOdometryEdges { wanted, found: order.len() });
    }
    order.shuffle(&mut random(seed, "odometry gaps"));
    let before = chains(graph);
    let removed = draw(graph, &order, wanted);
    let mut index = 0;
    graph.edges.retain(|_| {
        index += 1;
        !removed[index - 1]
    });
    for (index, edge) in graph.edges.iter_mut().enumerate() {
        edge.id = index as u64;
    }
    let after = chains(graph);
    let starts: Vec<Option<Vec<f64>>> = after.iter().map(|&start| graph.nodes[start].pose.clone()).collect();
    for (index, start) in starts.iter().enumerate() {
        if after[index] != before[index] {
            restart(graph.header.dimension, start.as_deref(), &mut graph.nodes[index]);
        }
    }
    Ok(after.iter().enumerate().filter(|&(index, &start)| index == start).count())
}

/// Marks the edges to remove: the first of the order that leave both their nodes with odometry, then the first others.
fn draw(graph: &PoseGraph, order: &[usize], wanted: usize) -> Vec<bool> {
    let mut edges_at: HashMap<u64, usize> = HashMap::new();
    for &index in order {
        for node in [graph.edges[index].from, graph.edges[index].to] {
            *edges_at.entry(node).or_default() += 1;
        }
    }
    let mut removed = vec![false; graph.edges.len()];
    let mut gaps = 0;
    for may_isolate in [false, true] {
        for &index in order {
            let ends = [graph.edges[index].from, graph.edges[index].to];
            let isolates = ends.iter().any(|node| edges_at[node] == 1);
            if gaps == wanted || removed[index] || (isolates && !may_isolate) {
                continue;
            }
            removed[index] = true;
            gaps += 1;
            for node in ends {
                *edges_at.entry(node).or_default() -= 1;
            }
        }
    }
    removed
}

/// For each node, the first node (by index) of its odometry chain.
fn chains(graph: &PoseGraph) -> Vec<usize> {
    let mut forest = Forest::new(graph.nodes.len());
    for (from, to) in graph.edges_of(EdgeKind::Odometry).filter_map(|edge| graph.ends(edge)) {
        forest.join(from, to);
    }
    (0..graph.nodes.len()).map(|node| forest.root(node)).collect()
}

//! The chains of odometry in the order in which posecut-verify calibrates them.

use posecut_graph::{EdgeKind, PoseGraph};
use posecut_pcm::chain::paths;

use crate::survey::length;

/// The nodes of each chain, or of each piece of a chain that is broken at one of these edges.
///
/// Chains are sorted by first frame, number of nodes and distance travelled, then by session; a chain starts at the end from which
/// most of its odometry edges point away. O(n log n).
pub fn in_order(graph: &PoseGraph, broken: &[usize]) -> Vec<Vec<usize>> {
    let mut chains = paths(graph);
    let mut places = vec![(0, 0); graph.nodes.len()];
    for (number, chain) in chains.iter().enumerate() {
        for (place, &node) in chain.iter().enumerate() {
            places[node] = (number, place);
        }
    }
    let mut forward = vec![0_i64; chains.len()];
    let mut travelled = vec![0.0; chains.len()];
    for edge in graph.edges_of(EdgeKind::Odometry) {
        let Some((from, to)) = graph.ends(edge) else { continue };
        let ((chain, from), (other, to)) = (places[from], places[to]);
        if chain == other {
            forward[chain] += if from < to { 1 } else { -1 };
            let motion = edge.measurement.as_deref().and_then(|pose| graph.header.dimension.spatial(pose));
            travelled[chain] += motion.map_or(0.0, |motion| length(&motion));
        }
    }
    for (chain, forward) in chains.iter_mut().zip(&forward) {
        if *forward < 0 {
            chain.reverse();
        }
    }
    let mut chains: Vec<(Vec<usize>, f64)> = chains.into_iter().zip(travelled).collect();
    chains.sort_by(|(one, one_travelled), (other, other_travelled)| {
        let first = |chain: &[usize]| &graph.nodes[chain[0]];
        let key = |chain: &[usize]| (first(chain).frame, chain.len());
        key(one)
            .cmp(&key(other))
            .then(one_travelled.total_cmp(other_travelled))
            .then_with(|| first(one).session.cmp(&first(other).session))
    });
    let order = chains.into_iter().map(|(nodes, _)| nodes);
    if broken.is_empty() { order.collect() } else { pieces(graph, order.flatten(), broken) }
}

/// The chains without the broken edges, by their first nodes in this order.
fn pieces(graph: &PoseGraph, order: impl Iterator<Item = usize>, broken: &[usize]) -> Vec<Vec<usize>> {
    let mut rank = vec![0; graph.nodes.len()];
    for (number, node) in order.enumerate() {
        rank[node] = number;
    }
    let mut split = graph.clone();
    for &edge in broken {
        if let Some(edge) = split.edges.get_mut(edge) {
            edge.reject("verify");
        }
    }
    let mut pieces = paths(&split);
    pieces.sort_by_key(|piece| piece.iter().map(|&node| rank[node]).min());
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn graph(odometry: &[(u64, u64)]) -> PoseGraph {
        let mut text =
            String::from("{\"kind\":\"header\",\"format\":\"posecut\",\"version\":1,\"dimension\":2}\n");
        for id in 0..6 {
            text += &format!("{{\"kind\":\"node\",\"id\":{id},\"session\":\"s\",\"frame\":{id}}}\n");
        }
        for (id, (from, to)) in odometry.iter().enumerate() {
            text += &format!(
                "{{\"kind\":\"odometry\",\"id\":{id},\"from\":{from},\"to\":{to},\"measurement\":[1,0,0],\"information\":[1,0,0,1,0,1]}}\n"
            );
        }
        PoseGraph::read("test", text.as_bytes()).unwrap()
    }

    #[test]
    fn chains_come_by_first_frame_and_their_pieces_in_order() {
        // The second chain is written backwards, so it starts at node 5.
        let graph = graph(&[(0, 1), (1, 2), (5, 4), (4, 3)]);
        assert_eq!(in_order(&graph, &[]), [vec![0, 1, 2], vec![5, 4, 3]]);
        let pieces = in_order(&graph, &[1, 2]);
        assert_eq!(pieces, [vec![0, 1], vec![2], vec![5], vec![3, 4]]);
    }
}

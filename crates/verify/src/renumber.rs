//! An order of nodes that does not depend on their ids.

use std::borrow::Cow;

use posecut_graph::{EdgeKind, PoseGraph};
use posecut_pcm::chain::paths;

use crate::model::Motion;

/// The graph with its nodes numbered along its chains of odometry. The calibration may have several optima that are nearly
/// equal. Which of them it finds depends on the order of chains, and on which end of a chain comes first, so this order must
/// not depend on ids.
///
/// A chain starts at the end from which most of its odometry edges point away. Chains are sorted by first frame, number of
/// nodes and distance travelled; session names, and then ids, decide only where all of these are equal. Edges keep their
/// indices. O(n log n).
pub(crate) fn renumbered<G: Motion<DOF>, const DOF: usize>(graph: &PoseGraph) -> Cow<'_, PoseGraph> {
    let mut chains: Vec<Chain> = paths(graph).into_iter().map(Chain::new).collect();
    let mut places = vec![(0, 0); graph.nodes.len()];
    for (number, chain) in chains.iter().enumerate() {
        for (place, &node) in chain.nodes.iter().enumerate() {
            places[node] = (number, place);
        }
    }
    for edge in graph.edges_of(EdgeKind::Odometry) {
        let place = |id| graph.node_index(id).map(|node| places[node]);
        if let (Some((chain, from)), Some((other, to))) = (place(edge.from), place(edge.to))
            && chain == other
        {
            chains[chain].forward += if from < to { 1 } else { -1 };
            let motion = edge.measurement.as_deref().and_then(G::from_components);
            chains[chain].travelled += motion.map_or(0.0, |motion| {
                motion.translation().iter().fold(0.0, |length: f64, step| length.hypot(*step))
            });
        }
    }
    for chain in chains.iter_mut().filter(|chain| chain.forward < 0) {
        chain.nodes.reverse();
    }
    chains.sort_by(|one, other| {
        let first = |chain: &Chain| &graph.nodes[chain.nodes[0]];
        let key = |chain: &Chain| (first(chain).frame, chain.nodes.len());
        key(one)
            .cmp(&key(other))
            .then(one.travelled.total_cmp(&other.travelled))
            .then_with(|| first(one).session.cmp(&first(other).session))
    });
    let nodes: Vec<usize> = chains.into_iter().flat_map(|chain| chain.nodes).collect();
    if nodes.is_sorted() { Cow::Borrowed(graph) } else { Cow::Owned(in_order(graph, &nodes)) }
}

/// The nodes of a chain of odometry.
struct Chain {
    nodes: Vec<usize>,
    /// Number of its edges that point from the first node to the last, minus those that point back.
    forward: i64,
    /// The sum of the lengths of its edges.
    travelled: f64,
}

impl Chain {
    fn new(nodes: Vec<usize>) -> Self {
        Self { nodes, forward: 0, travelled: 0.0 }
    }
}

/// The graph with these nodes renumbered 0, 1, 2 and so on.
fn in_order(graph: &PoseGraph, nodes: &[usize]) -> PoseGraph {
    let mut number = vec![0; nodes.len()];
    let mut renamed = graph.clone();
    renamed.nodes.clear();
    for (&node, id) in nodes.iter().zip(0..) {
        number[node] = id;
        renamed.nodes.push(posecut_graph::Node { id, ..graph.nodes[node].clone() });
    }
    for edge in &mut renamed.edges {
        for end in [&mut edge.from, &mut edge.to] {
            // An end that does not exist must not exist in the result either.
            *end = graph.node_index(*end).map_or(u64::MAX, |node| number[node]);
        }
    }
    renamed
}

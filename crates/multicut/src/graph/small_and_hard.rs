//! Seeded graphs that are small and hard: unions of sparse random graphs with real costs, and cluster editing.

use std::collections::BTreeSet;

use posecut_random::rand::RngExt as _;
use posecut_random::{ChaCha8Rng, random};

use crate::{Graph, GraphError};

/// How the edges of a random graph are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawing {
    /// All sets of that many edges are equally likely (Erdos, Renyi 1959).
    Uniform,
    /// Each node after the first ones is joined to earlier ones with probabilities in proportion to their degrees (Barabasi,
    /// Albert 1999), until the edges are used up evenly.
    Attachment,
}

/// Draws a disjoint union of `count` random graphs with `nodes` nodes and `edges` edges each, at most all pairs. Costs are
/// uniform between -1 and 1.
///
/// `O(count edges log edges)` where the graphs are sparse; the same seed gives the same graph on every machine.
///
/// ```
/// use posecut_multicut::small_and_hard::{Drawing, random_union};
/// let graph = random_union(Drawing::Attachment, 50, 60, 220, 1)?;
/// assert_eq!((graph.node_count(), graph.edges().len()), (3000, 11000));
/// # Ok::<(), posecut_multicut::GraphError>(())
/// ```
pub fn random_union(
    drawing: Drawing,
    count: u32,
    nodes: u32,
    edges: u32,
    seed: u64,
) -> Result<Graph, GraphError> {
    let mut place = random(seed, "edges");
    let mut cost = random(seed, "costs");
    let mut all = Vec::new();
    for part in 0..count {
        let pairs = match drawing {
            Drawing::Uniform => uniform(nodes, edges, &mut place),
            Drawing::Attachment => attachment(nodes, edges, &mut place),
        };
        let first = u64::from(part) * u64::from(nodes);
        all.extend(pairs.into_iter().map(|(tail, head)| {
            (first + u64::from(tail), first + u64::from(head), cost.random_range(-1.0..1.0))
        }));
    }
    Graph::new((u64::from(count) * u64::from(nodes)) as usize, all)
}

fn pairs_of(nodes: u32) -> u64 {
    u64::from(nodes) * u64::from(nodes.saturating_sub(1)) / 2
}

fn uniform(nodes: u32, edges: u32, random: &mut ChaCha8Rng) -> BTreeSet<(u32, u32)> {
    let wanted = u64::from(edges).min(pairs_of(nodes)) as usize;
    let mut pairs = BTreeSet::new();
    while pairs.len() < wanted {
        let (a, b) = (random.random_range(0..nodes), random.random_range(0..nodes));
        if a != b {
            pairs.insert((a.min(b), a.max(b)));
        }
    }
    pairs
}

fn attachment(nodes: u32, edges: u32, random: &mut ChaCha8Rng) -> BTreeSet<(u32, u32)> {
    let wanted = u64::from(edges).min(pairs_of(nodes));
    let mut pairs = BTreeSet::new();
    // Every end of every edge, so that a uniform choice among them is in proportion to the degrees.
    let mut ends: Vec<u32> = vec![0];
    for node in 1..nodes {
        // The share of edges that this and all earlier nodes should have brought; each node brings at most one for each of
        // these, so the first few fall behind.
        let due = wanted * u64::from(node) / u64::from(nodes - 1);
        let mut left = (due - (pairs.len() as u64).min(due)).min(u64::from(node));
        let mut fresh = Vec::new();
        while left > 0 {
            let other = ends[random.random_range(0..ends.len())];
            let other = if other == node { random.random_range(0..node) } else { other };
            let pair = if pairs.contains(&(other, node)) {
                (random.random_range(0..node), node)
            } else {
                (other, node)
            };
            if pairs.insert(pair) {
                fresh.extend([pair.0, node]);
                left -= 1;
            }
        }
        ends.append(&mut fresh);
    }
    pairs
}

/// Draws an instance of cluster editing: a complete graph on `nodes` nodes, each in one of `clusters` clusters at random. Pairs
/// in one cluster attract, others repel; the share `flipped` of all pairs has the opposite sign. Costs are 1, or uniform
/// between 0.5 and 1.5 if `weighted`.
///
/// `O(nodes^2)`; the same seed gives the same graph on every machine.
pub fn cluster_editing(
    nodes: u32,
    clusters: u32,
    flipped: f64,
    weighted: bool,
    seed: u64,
) -> Result<Graph, GraphError> {
    let mut place = random(seed, "clusters");
    let cluster: Vec<u32> = (0..nodes).map(|_| place.random_range(0..clusters.max(1))).collect();
    let (mut flip, mut weight) = (random(seed, "flips"), random(seed, "weights"));
    let mut edges = Vec::new();
    for (head, &of_head) in cluster.iter().enumerate() {
        for (tail, &of_tail) in cluster[..head].iter().enumerate() {
            let attracts = (of_head == of_tail) != (flip.random::<f64>() < flipped);
            let cost = if weighted { weight.random_range(0.5..1.5) } else { 1.0 };
            edges.push((tail as u64, head as u64, if attracts { cost } else { -cost }));
        }
    }
    Graph::new(nodes as usize, edges)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unions_have_the_edges_asked_for_and_a_seed_fixes_them() {
        for drawing in [Drawing::Uniform, Drawing::Attachment] {
            let draw = |seed| random_union(drawing, 3, 60, 220, seed).unwrap();
            let graph = draw(1);
            assert_eq!(graph, draw(1));
            assert_ne!(graph, draw(2));
            let mut pairs = BTreeSet::new();
            for edge in graph.edges() {
                assert!(edge.tail / 60 == edge.head / 60 && edge.tail != edge.head);
                assert!(pairs.insert((edge.tail.min(edge.head), edge.tail.max(edge.head))));
            }
            assert_eq!(pairs.len(), 660);
            let repulsive = graph.edges().iter().filter(|edge| edge.cost < 0.0).count();
            assert!((260..=400).contains(&repulsive), "{repulsive}");
            // More edges than pairs: all pairs.
            assert_eq!(random_union(drawing, 1, 4, 100, 1).unwrap().edges().len(), 6);
            assert_eq!(random_union(drawing, 2, 0, 5, 1).unwrap().node_count(), 0);
        }
    }

    #[test]
    fn attachment_makes_hubs() {
        let largest = |drawing| {
            let graph = random_union(drawing, 1, 300, 1100, 5).unwrap();
            let mut degree = vec![0; 300];
            for edge in graph.edges() {
                degree[edge.tail as usize] += 1;
                degree[edge.head as usize] += 1;
            }
            degree.into_iter().max().unwrap()
        };
        assert!(largest(Drawing::Attachment) > 2 * largest(Drawing::Uniform));
    }

    #[test]
    fn cluster_editing_flips_the_share_asked_for() {
        let draw = |seed| cluster_editing(120, 6, 0.1, false, seed).unwrap();
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1), draw(2));
        assert_eq!(draw(1).edges().len(), 120 * 119 / 2);
        let flips = |flipped| {
            let signs = |share| -> Vec<bool> {
                let graph = cluster_editing(120, 6, share, true, 3).unwrap();
                graph.edges().iter().map(|edge| edge.cost > 0.0).collect()
            };
            signs(0.0).iter().zip(&signs(flipped)).filter(|(a, b)| a != b).count()
        };
        assert_eq!(flips(0.0), 0);
        assert!((600..=830).contains(&flips(0.1)), "{}", flips(0.1));
        assert!(cluster_editing(9, 0, 0.0, true, 1).unwrap().edges().iter().all(|edge| edge.cost >= 0.5));
    }
}

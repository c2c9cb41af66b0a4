//! Simulated annealing of small graphs.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::kernighan_lin::kernighan_lin_with_joins;
use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;

/// First temperatures of rounds, used in turn, in mean absolute costs.
const HEAT: [f64; 4] = [1.0, 0.5, 2.0, 0.7];

/// Share of the first temperature at which a round ends.
const COLD: f64 = 0.1;

/// Proposals of a round for each node: in the first rounds, and the most, to which they grow by halves.
const PROPOSALS: (usize, usize) = (200, 1_000);

/// Steps of the temperature in a round.
const STEPS: usize = 50;

/// One round in this many starts from single nodes.
const FRESH: usize = 3;

/// Work of a proposal.
const PROPOSAL: u64 = 4;

/// Improves `labels` by simulated annealing: moves of random nodes, each to the cluster of a random neighbour or out of its
/// own cluster, accepted with probability `e^(-rise / temperature)` (Kirkpatrick, Gelatt, Vecchi 1983; for clusterings of
/// complete graphs de Amorim, Barthelemy, Ribeiro 1992), and Kernighan-Lin with joins from the end of each round. Rounds
/// start from the best labels, and every third from single nodes. Ends when `effort` is spent. Never worsens.
///
/// The pull of each cluster on each node is kept, so that a proposal costs `O(1)` and a move `O(d)` for a node of degree `d`.
/// That takes `n (n + 1)` numbers for `n` nodes.
pub(crate) fn anneal(
    graph: &SignedGraph,
    labels: &mut Vec<u32>,
    effort: u64,
    seed: u64,
    budget: &mut Budget,
) {
    let nodes = graph.node_count();
    let end = budget.spent().saturating_add(effort);
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let mut objective = graph.objective(labels);
    let edges = graph.edges().count();
    let mean = graph.edges().map(|edge| edge.2.abs()).sum::<f64>() / edges.max(1) as f64;
    let mut proposals = PROPOSALS.0;
    let singletons: Vec<u32> = graph.nodes().collect();
    // The n-th root by a loop: every machine gets the same number.
    let cooling = root(COLD, STEPS);
    for round in 0.. {
        if nodes == 0 || budget.spent() >= end || !budget.spend(nodes as u64) {
            return;
        }
        // From a good solution, a round cannot leave its basin if few edges attract; from single nodes it can.
        let mut clusters =
            if round % FRESH == 1 { Clusters::new(graph, &singletons) } else { Clusters::new(graph, labels) };
        let mut temperature = HEAT[round % HEAT.len()] * mean;
        let each = proposals * nodes / STEPS;
        for _ in 0..STEPS {
            let moved = clusters.propose(each, temperature, &mut random);
            budget.spend(moved + PROPOSAL * each as u64);
            temperature *= cooling;
            if budget.is_over() {
                return;
            }
        }
        if round % HEAT.len() + 1 == HEAT.len() {
            proposals = (proposals + proposals / 2).min(PROPOSALS.1);
        }
        let mut other = graph.connected_labels(&clusters.labels);
        kernighan_lin_with_joins(graph, &mut other, budget);
        let value = graph.objective(&other);
        if value <= objective {
            (objective, *labels) = (value, other);
        }
    }
}

/// The positive number whose power is `value`, by bisection.
fn root(value: f64, power: usize) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (0..power).fold(1.0, |product, _| product * middle) < value {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// `e^-x` to within a few per cent where it matters, by multiplications alone, which are the same on every machine.
fn decay(x: f64) -> f64 {
    let mut power = (1.0 - x / 64.0).max(0.0);
    for _ in 0..6 {
        power *= power;
    }
    power
}

/// A labelling, with the pull of every cluster on every node.
struct Clusters<'a> {
    graph: &'a SignedGraph,
    labels: Vec<u32>,
    sizes: Vec<u32>,
    /// Clusters without nodes; never empty.
    free: Vec<u32>,
    /// Sum of costs from a node to a cluster, at `node * sizes.len() + cluster`.
    pull: Vec<f64>,
}

impl<'a> Clusters<'a> {
    fn new(graph: &'a SignedGraph, labels: &[u32]) -> Self {
        let nodes = graph.node_count();
        let count = nodes + 1;
        let mut sizes = vec![0u32; count];
        let mut pull = vec![0.0; nodes * count];
        for node in graph.nodes() {
            sizes[labels[node as usize] as usize] += 1;
            for arc in graph.arcs(node) {
                pull[node as usize * count + labels[arc.node as usize] as usize] += arc.cost;
            }
        }
        let free = (0..count as u32).rev().filter(|&cluster| sizes[cluster as usize] == 0).collect();
        Self { graph, labels: labels.to_vec(), sizes, free, pull }
    }

    /// By how much a move raises the objective.
    fn rise(&self, node: u32, to: u32) -> f64 {
        let row = node as usize * self.sizes.len();
        let own = self.labels[node as usize] as usize;
        self.pull[row + own] - self.pull[row + to as usize]
    }

    /// Proposes moves; returns the number of arcs at nodes that moved.
    fn propose(&mut self, count: usize, temperature: f64, random: &mut ChaCha8Rng) -> u64 {
        let mut arcs_moved = 0;
        for _ in 0..count {
            let node = random.random_range(0..self.labels.len() as u32);
            let arcs = self.graph.arcs(node);
            if arcs.is_empty() {
                continue;
            }
            let own = self.labels[node as usize];
            let mut to = self.labels[arcs[random.random_range(0..arcs.len())].node as usize];
            if to == own {
                // The node leaves.
                let Some(&empty) = self.free.last() else { continue };
                to = empty;
            }
            let rise = self.rise(node, to);
            if rise > 0.0 && random.random::<f64>() >= decay(rise / temperature) {
                continue;
            }
            self.relabel(node, to);
            arcs_moved += arcs.len() as u64;
        }
        arcs_moved
    }

    fn relabel(&mut self, node: u32, to: u32) {
        let own = std::mem::replace(&mut self.labels[node as usize], to);
        self.sizes[own as usize] -= 1;
        self.sizes[to as usize] += 1;
        if self.free.last() == Some(&to) {
            self.free.pop();
        }
        if self.sizes[own as usize] == 0 {
            self.free.push(own);
        }
        let count = self.sizes.len();
        for arc in self.graph.arcs(node) {
            let row = arc.node as usize * count;
            self.pull[row + own as usize] -= arc.cost;
            self.pull[row + to as usize] += arc.cost;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heuristics::greedy::{Preference, additive_edge_contraction};

    #[test]
    fn annealing_never_worsens_and_finds_what_contraction_misses() {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let mut better = 0;
        for seed in 0..20 {
            let pairs = (0..25u32).flat_map(|u| (0..u).map(move |v| (u, v)));
            let edges: Vec<_> = pairs.map(|(u, v)| (u, v, random.random_range(-1.0..1.0))).collect();
            let graph = SignedGraph::new(25, edges.into_iter());
            let budget = &mut Budget::new(None, None);
            let mut labels = additive_edge_contraction(&graph, Preference::Degree, budget);
            let before = graph.objective(&labels);
            anneal(&graph, &mut labels, 100_000, seed, budget);
            let after = graph.objective(&labels);
            assert!(after <= before);
            better += u32::from(after < before - 1e-9);
        }
        assert!(better >= 15, "{better}");
    }

    #[test]
    fn pulls_follow_moves() {
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let pairs = (0..12u32).flat_map(|u| (0..u).map(move |v| (u, v)));
        let edges: Vec<_> = pairs.map(|(u, v)| (u, v, f64::from(random.random_range(-3..=3)))).collect();
        let graph = SignedGraph::new(12, edges.into_iter());
        let mut clusters = Clusters::new(&graph, &[0; 12]);
        clusters.propose(500, 4.0, &mut random);
        let fresh = Clusters::new(&graph, &clusters.labels);
        assert_eq!((&clusters.pull, &clusters.sizes), (&fresh.pull, &fresh.sizes));
        assert!(clusters.labels.iter().any(|&label| label != 0));
        for node in graph.nodes() {
            for to in 0..13 {
                let mut moved = clusters.labels.clone();
                moved[node as usize] = to;
                let rise = graph.objective(&moved) - graph.objective(&clusters.labels);
                assert!(
                    (clusters.rise(node, to) - rise).abs() < 1e-9 || to == clusters.labels[node as usize]
                );
            }
        }
    }

    #[test]
    fn decay_is_close_to_the_exponential_function() {
        for step in 0..=40 {
            let x = f64::from(step) * 0.2;
            assert!((decay(x) - (-x).exp()).abs() < 0.006, "{x}");
        }
        assert_eq!(decay(100.0), 0.0);
    }
}

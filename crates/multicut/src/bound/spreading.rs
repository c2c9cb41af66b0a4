//! Packings that prove a multicut of a dense graph optimal.

mod choices;

use choices::{Choices, Payers};

use super::packing::Packing;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// Most edges that a conflict pays for, pass by pass: small ones first, because their packing has more choices. Further passes
/// move demands between nodes.
const GROUPS: [usize; 12] = [1, 2, 4, 6, 8, 8, 8, 8, 8, 8, 8, 8];

/// Passes after which the bound must be better than any known before.
const TRIAL: usize = 3;

/// Passes in a row that may not raise the bound.
const IDLE: usize = 3;

/// Most rounds.
const ROUNDS: usize = 300;

/// Rounds in a row in which the worst overload may fall by less than [`PROGRESS`] of itself.
const PATIENCE: usize = 20;
const PROGRESS: f64 = 0.01;

/// Largest strength of a node, and inverse of the smallest.
const STRONGEST: f64 = 1e3;

/// Largest share of a capacity that is used, so that rounding errors do not exceed it.
const FULL: f64 = 1.0 - 1e-13;

/// Packs the capacity of each edge that `labels` pay for by *tight* conflicts, for which they pay no more than they must: the
/// packing proves the labels optimal if it uses up all that they pay for (see [`rerouting`](super::rerouting)). Where clusters
/// are large, each paid edge lies in many tight conflicts, and if its capacity is spread evenly over them, hardly any other
/// edge is overfull. There are two kinds:
///
/// * an uncut repulsive edge, and two attractive edges from its ends to a node of its cluster;
/// * a group of cut attractive edges from one node `v` to nodes of different clusters that repel each other, and an attractive
///   edge from `v` to a node of its cluster that repels them: a conflicted triangle if the group is one edge, otherwise a
///   2-partition inequality. The larger the groups, the less they take of the edges inside clusters, which are scarce where
///   clusters are small.
///
/// Starts from even shares. Then each round divides the share of a conflict by the square root of the load of its fullest edge,
/// relative to the edge's capacity, and scales the shares of each group to its capacity again, until no edge is overfull
/// (multiplicative updates for packing; Plotkin, Shmoys, Tardos 1995). At the end, shares over edges that are still overfull
/// are scaled down.
///
/// A cut edge can be paid for by conflicts around either end. Its demand is divided in the ratio of the ends' *strengths*. After
/// each pass, the strength of a node is divided by the mean load of the fullest edges of its conflicts, so that a node in a
/// small cluster, or one between two clusters, leaves its cut edges to their other ends.
///
/// Returns the best packing over several passes, as soon as one reaches `target`; `None` if there are no conflicts, or too many.
/// Gives up if no packing is better than `known` after a few passes: clusters are not clear enough.
///
/// Finds the conflicts of `p` paid edges in `O(p d)` for degrees `d` and a constant size of groups; a round is linear in the
/// edges that all conflicts use.
pub(crate) fn spread(
    kernel: &Kernel,
    labels: &[u32],
    known: f64,
    target: f64,
    budget: &mut Budget,
) -> Option<Packing> {
    let mut best: Option<Packing> = None;
    let mut strengths = vec![1.0; kernel.node_count()];
    let mut idle = 0;
    for (pass, size) in GROUPS.into_iter().enumerate() {
        let Some(choices) = Choices::new(kernel, labels, size, &strengths, budget) else { break };
        let (packing, pressure) = choices.balance(budget);
        idle += 1;
        if best.as_ref().is_none_or(|best| packing.bound > best.bound) {
            best = Some(packing);
            idle = 0;
        }
        let bound = best.as_ref().map_or(f64::NEG_INFINITY, |best| best.bound);
        let poor = pass + 1 >= TRIAL && bound < known;
        if bound >= target || poor || idle == IDLE || budget.is_over() {
            break;
        }
        for (strength, pressure) in strengths.iter_mut().zip(pressure) {
            *strength = (*strength / pressure).clamp(1.0 / STRONGEST, STRONGEST);
        }
    }
    best
}

impl Choices<'_> {
    /// The packing after rounds of multiplicative updates, and the pressure on each node.
    fn balance(&self, budget: &mut Budget) -> (Packing, Vec<f64>) {
        let mut shares = vec![0.0; self.kept.len()];
        for item in &self.items {
            shares[item.choices.clone()].fill(item.demand / item.choices.len() as f64);
        }
        let (mut least, mut idle) = (f64::INFINITY, 0);
        let mut fill = self.fill(&shares);
        for _ in 0..ROUNDS {
            let worst = fill.iter().copied().fold(0.0, f64::max);
            if worst <= FULL || idle > PATIENCE || !budget.spend(2 * self.edges.len() as u64) {
                break;
            }
            idle += 1;
            if worst < least * (1.0 - PROGRESS) {
                (least, idle) = (worst, 0);
            }
            self.shift(&fill, &mut shares);
            fill = self.fill(&shares);
        }
        (self.packing(&fill, &shares), self.pressure(&fill, &shares))
    }

    /// The mean load of the fullest edges of the conflicts around each node, by their shares; 1 where there are none.
    fn pressure(&self, fill: &[f64], shares: &[f64]) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); self.kernel.node_count()];
        for item in &self.items {
            let Payers::Star(centre, _) = item.payers else { continue };
            let (load, share) = &mut sums[centre as usize];
            for choice in item.choices.clone() {
                *load += shares[choice] * self.fullest(fill, choice);
                *share += shares[choice];
            }
        }
        sums.into_iter().map(|(load, share)| if load > 0.0 { load / share } else { 1.0 }).collect()
    }

    /// The load of each edge that is not paid, relative to its capacity.
    fn fill(&self, shares: &[f64]) -> Vec<f64> {
        let mut fill = vec![0.0; self.kernel.edge_count()];
        for ((_, edges), share) in self.kept.iter().zip(shares) {
            for &edge in &self.edges[edges.clone()] {
                fill[edge as usize] += share;
            }
        }
        for (fill, cost) in fill.iter_mut().zip(&self.kernel.costs) {
            *fill /= cost.abs();
        }
        fill
    }

    fn fullest(&self, fill: &[f64], choice: usize) -> f64 {
        self.edges[self.kept[choice].1.clone()].iter().map(|&edge| fill[edge as usize]).fold(0.0, f64::max)
    }

    /// Moves shares from full edges to others.
    fn shift(&self, fill: &[f64], shares: &mut [f64]) {
        for item in &self.items {
            let mut sum = 0.0;
            for choice in item.choices.clone() {
                shares[choice] /= self.fullest(fill, choice).sqrt();
                sum += shares[choice];
            }
            let scale = item.demand / sum;
            shares[item.choices.clone()].iter_mut().for_each(|share| *share *= scale);
        }
    }

    fn packing(&self, fill: &[f64], shares: &[f64]) -> Packing {
        let mut packing = Packing::new(self.kernel);
        for item in &self.items {
            for choice in item.choices.clone() {
                let conflict = item.payers.conflict(self.kept[choice].0);
                let uses = conflict.uses(self.kernel);
                let weight = shares[choice] / self.fullest(fill, choice).max(1.0);
                let weight = weight.min(packing.room(&uses));
                if weight > 0.0 {
                    packing.add(conflict, &uses, weight);
                }
            }
        }
        packing
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;
    use crate::bound::conflict::{Conflict, Parts};
    use crate::graph::signed_graph::SignedGraph;

    /// A complete graph with planted clusters of 25 nodes, where this share of the edges has the wrong sign.
    fn planted(nodes: u32, flipped: f64, seed: u64) -> (Kernel, Vec<u32>) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let labels: Vec<u32> = (0..nodes).map(|node| node / 25).collect();
        let pairs = (0..nodes).flat_map(|u| (0..u).map(move |v| (u, v)));
        let edges: Vec<_> = pairs
            .map(|(u, v)| {
                let cost = random.random_range(0.5..1.5);
                let joined = labels[u as usize] == labels[v as usize];
                (u, v, if joined == random.random_bool(flipped) { -cost } else { cost })
            })
            .collect();
        (Kernel::new(&SignedGraph::new(nodes as usize, edges.into_iter())), labels)
    }

    fn objective(kernel: &Kernel, labels: &[u32]) -> f64 {
        let cut = |&&(tail, head): &&(u32, u32)| labels[tail as usize] != labels[head as usize];
        kernel.ends.iter().zip(&kernel.costs).filter(|(ends, _)| cut(ends)).map(|entry| entry.1).sum()
    }

    #[test]
    fn planted_clusters_are_proved_optimal() {
        for seed in 0..10 {
            // Triangles suffice only for few wrong signs.
            let (kernel, labels) = planted(200, if seed < 5 { 0.03 } else { 0.1 }, seed);
            let target = objective(&kernel, &labels) - 1e-9;
            let packing =
                spread(&kernel, &labels, f64::NEG_INFINITY, target, &mut Budget::new(None, None)).unwrap();
            let stars = packing.conflicts.iter().any(|packed| matches!(packed.conflict, Conflict::Parts(_)));
            assert_eq!(stars, seed >= 5);
            let objective = objective(&kernel, &labels);
            assert!((packing.bound - objective).abs() < 1e-7, "{} {objective}", packing.bound);
        }
    }

    #[test]
    fn a_small_cluster_leaves_its_cut_edges_to_larger_ones() {
        for seed in 0..5 {
            // The last cluster has 12 nodes. Half of the demand at either end overfills its edges.
            let (kernel, labels) = planted(212, 0.1, seed);
            let objective = objective(&kernel, &labels);
            let packing =
                spread(&kernel, &labels, f64::NEG_INFINITY, objective - 1e-9, &mut Budget::new(None, None));
            let bound = packing.unwrap().bound;
            assert!((bound - objective).abs() < 1e-7, "{bound} {objective}");
        }
    }

    /// Checks that a conflict is what its definition says.
    fn check(kernel: &Kernel, conflict: &Conflict) {
        let repels = |a: u32, b: u32| kernel.costs[kernel.edge(a, b).unwrap() as usize] < 0.0;
        match conflict {
            Conflict::Cycle(nodes) => {
                assert!(
                    repels(nodes[2], nodes[0]) && !repels(nodes[0], nodes[1]) && !repels(nodes[1], nodes[2])
                );
            }
            Conflict::Parts(Parts { few, many }) => {
                assert_eq!(few.len(), 1);
                for (place, &node) in many.iter().enumerate() {
                    assert!(!repels(few[0], node));
                    assert!(many[..place].iter().all(|&other| repels(node, other)));
                }
            }
            Conflict::Wheel(_) => unreachable!(),
        }
    }

    #[test]
    fn any_labels_give_a_packing() {
        let (kernel, planted) = planted(100, 0.05, 9);
        let best = objective(&kernel, &planted);
        let mut random = ChaCha8Rng::seed_from_u64(1);
        for clusters in 1..6u32 {
            let labels: Vec<u32> = (0..100).map(|_| random.random_range(0..clusters)).collect();
            let packing = spread(&kernel, &labels, f64::NEG_INFINITY, 0.0, &mut Budget::new(None, None));
            let Some(packing) = packing else { continue };
            assert!(packing.bound <= best + 1e-9);
            let mut load = vec![0.0; kernel.edge_count()];
            for packed in &packing.conflicts {
                for (edge, times) in packed.conflict.uses(&kernel) {
                    load[edge as usize] += packed.weight * f64::from(times);
                }
                check(&kernel, &packed.conflict);
            }
            assert!(load.iter().zip(&kernel.costs).all(|(load, cost)| *load <= cost.abs() + 1e-9));
        }
    }
}

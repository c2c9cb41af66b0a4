//! Fusion moves: local search from the results of heuristics.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::greedy::{Preference, additive_edge_contraction, greedy_fixation};
use super::kernighan_lin::kernighan_lin_with_joins;
use super::node_moves::move_nodes;
use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;
use crate::reduce::decomposition::decompose;

/// Ways to make a proposal, used in turn: what differs most combines best.
const WAYS: [Way; 4] = [
    Way::Contraction(Preference::Degree),
    Way::Fixation,
    Way::Contraction(Preference::Balance),
    Way::Contraction(Preference::Age),
];

/// How many of them make proposals that Kernighan-Lin polishes. That takes longer than a proposal, so only the best ways pay.
const BEST: usize = 2;

/// Amplitudes of the noise on costs, used in turn.
const NOISE: [f64; 4] = [0.3, 1.0, 0.1, 0.6];

/// Number of the first fusion move whose proposal is made with noise.
pub(crate) const NOISY: usize = WAYS.len();

/// Number of edges above which a graph is large.
pub(crate) const LARGE: usize = 200_000;

/// A way to make a proposal.
#[derive(Debug, Clone, Copy)]
enum Way {
    Contraction(Preference),
    Fixation,
}

impl Way {
    fn propose(self, graph: &SignedGraph, budget: &mut Budget) -> Vec<u32> {
        match self {
            Self::Contraction(preference) => additive_edge_contraction(graph, preference, budget),
            Self::Fixation => greedy_fixation(graph, budget),
        }
    }
}

/// A sequence of fusion moves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fusions {
    /// Number of the first move. Proposals before [`NOISY`] take the costs as they are, later ones with noise.
    pub(crate) first: usize,
    /// Most moves.
    pub(crate) most: usize,
    /// Gain of four moves below which no more follow.
    pub(crate) worth: f64,
    /// Improves proposals and combinations.
    pub(crate) polish: Polish,
    pub(crate) seed: u64,
}

/// Improves `labels` by fusion moves (Beier, Hamprecht, Kappes, CVPR 2015). A proposal comes from greedy contraction or
/// fixation. A good combination of proposal and incumbent follows by contracting the edges that both join, reducing, and
/// solving the small rest heuristically. Never worsens.
pub(crate) fn fuse_proposals(
    graph: &SignedGraph,
    labels: &mut Vec<u32>,
    moves: &Fusions,
    budget: &mut Budget,
) {
    let mut random = ChaCha8Rng::seed_from_u64(moves.seed);
    let before = graph.objective(labels);
    let (mut objective, mut last) = (before, before);
    for round in moves.first..moves.first + moves.most {
        if !budget.spend(graph.node_count() as u64) {
            return;
        }
        let ways = if moves.polish == Polish::Moves { WAYS.len() } else { BEST };
        let way = WAYS[round % ways];
        let mut proposal = if round < NOISY {
            way.propose(graph, budget)
        } else {
            way.propose(&noisy(graph, NOISE[round % NOISE.len()], &mut random), budget)
        };
        moves.polish.run(graph, &mut proposal, budget);
        if budget.is_over() {
            return;
        }
        let fused = fuse(graph, labels, &proposal, moves.polish, budget);
        for candidate in [proposal, fused] {
            let value = graph.objective(&candidate);
            if value < objective {
                objective = value;
                *labels = candidate;
            }
        }
        if (round + 1 - moves.first).is_multiple_of(WAYS.len()) {
            if last - objective < moves.worth {
                break;
            }
            last = objective;
        }
    }
    if moves.polish == Polish::Moves && objective < before {
        kernighan_lin_with_joins(graph, labels, budget);
    }
}

/// The graph with costs that are off by up to the share `amplitude`.
fn noisy(graph: &SignedGraph, amplitude: f64, random: &mut ChaCha8Rng) -> SignedGraph {
    let edges: Vec<(u32, u32, f64)> = graph
        .edges()
        .map(|(tail, head, cost)| (tail, head, cost * (1.0 + amplitude * random.random_range(-1.0..1.0))))
        .collect();
    SignedGraph::new(graph.node_count(), edges.into_iter())
}

/// A good combination of two labellings: nodes joined in both stay joined.
pub(crate) fn fuse(
    graph: &SignedGraph,
    first: &[u32],
    second: &[u32],
    polish: Polish,
    budget: &mut Budget,
) -> Vec<u32> {
    let together = |labels: &[u32], tail: u32, head: u32| labels[tail as usize] == labels[head as usize];
    let keep = |tail, head| together(first, tail, head) && together(second, tail, head);
    solve_contracted(graph, keep, polish, budget)
}

/// How a labelling is improved at last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Polish {
    Moves,
    KernighanLin,
}

impl Polish {
    /// Moves of single nodes where a graph is large and no band: another proposal gains more there than Kernighan-Lin, in less
    /// time.
    pub(crate) fn of(graph: &SignedGraph) -> Self {
        if graph.edges().count() > LARGE { Self::Moves } else { Self::KernighanLin }
    }

    fn run(self, graph: &SignedGraph, labels: &mut Vec<u32>, budget: &mut Budget) {
        match self {
            Self::Moves => move_nodes(graph, labels, budget),
            Self::KernighanLin => kernighan_lin_with_joins(graph, labels, budget),
        }
    }
}

/// A good labelling that joins the ends of the edges for which `keep` holds. The contracted graph is reduced, its kernels are
/// contracted greedily and polished, and at last the whole labelling is polished. Only large kernels are content with `polish`;
/// in others, Kernighan-Lin takes little time.
pub(crate) fn solve_contracted(
    graph: &SignedGraph,
    keep: impl Fn(u32, u32) -> bool,
    polish: Polish,
    budget: &mut Budget,
) -> Vec<u32> {
    let mut sets = UnionFind::new(graph.node_count());
    for (tail, head, _) in graph.edges() {
        if keep(tail, head) {
            sets.union(tail, head);
        }
    }
    let classes = sets.labels();
    let count = classes.iter().max().map_or(0, |&class| class as usize + 1);
    let quotient: Vec<(u32, u32, f64)> = graph
        .edges()
        .map(|(tail, head, cost)| (classes[tail as usize], classes[head as usize], cost))
        .filter(|(tail, head, _)| tail != head)
        .collect();
    let decomposition = decompose(SignedGraph::new(count, quotient.into_iter()), false, budget);
    let solved: Vec<Vec<u32>> = decomposition
        .kernels
        .iter()
        .map(|piece| {
            let mut labels = additive_edge_contraction(&piece.graph, Preference::Degree, budget);
            let polish = if polish == Polish::Moves { Polish::of(&piece.graph) } else { polish };
            polish.run(&piece.graph, &mut labels, budget);
            labels
        })
        .collect();
    let joined = decomposition.assemble(solved.iter().map(Vec::as_slice));
    let mut labels: Vec<u32> = classes.iter().map(|&class| joined[class as usize]).collect();
    polish.run(graph, &mut labels, budget);
    labels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Family, generate};

    fn drawn(seed: u64) -> SignedGraph {
        let instance = generate(Family::Aliased, 1000, 0.5, seed).unwrap();
        let edges = instance.edges().iter().map(|edge| (edge.tail, edge.head, edge.cost));
        SignedGraph::new(instance.node_count(), edges)
    }

    fn fused(graph: &SignedGraph, polish: Polish, most: usize, worth: f64) -> Vec<u32> {
        let mut labels = additive_edge_contraction(graph, Preference::Age, &mut Budget::new(None, None));
        let moves = Fusions { first: 0, most, worth, polish, seed: 1 };
        fuse_proposals(graph, &mut labels, &moves, &mut Budget::new(None, None));
        labels
    }

    #[test]
    fn fusions_gain_more_than_kernighan_lin_from_one_contraction() {
        for seed in 1..4 {
            let graph = drawn(seed);
            let mut alone = fused(&graph, Polish::Moves, 0, 0.0);
            kernighan_lin_with_joins(&graph, &mut alone, &mut Budget::new(None, None));
            for polish in [Polish::Moves, Polish::KernighanLin] {
                let labels = fused(&graph, polish, 8, 0.0);
                assert!(graph.objective(&labels) < graph.objective(&alone), "{seed} {polish:?}");
            }
        }
    }

    #[test]
    fn fusions_end_after_four_that_gain_too_little() {
        let graph = drawn(1);
        let four = fused(&graph, Polish::Moves, 4, 0.0);
        assert_eq!(fused(&graph, Polish::Moves, 40, f64::INFINITY), four);
        let more = fused(&graph, Polish::Moves, 40, 0.5);
        assert!(graph.objective(&more) < graph.objective(&four));
    }

    #[test]
    fn a_fusion_takes_the_better_half_of_each() {
        // Two conflicted triangles with a weak edge between them; each labelling solves one of them.
        let triangle = |at: u32| [(at, at + 1, 2.0), (at + 1, at + 2, 1.0), (at, at + 2, -3.0)];
        let edges: Vec<_> = triangle(0).into_iter().chain(triangle(3)).chain([(2, 3, 0.1)]).collect();
        let graph = SignedGraph::new(6, edges.into_iter());
        let budget = &mut Budget::new(None, None);
        let fused = fuse(&graph, &[0, 0, 1, 2, 2, 2], &[0, 0, 0, 2, 2, 3], Polish::KernighanLin, budget);
        assert!((graph.objective(&fused) - -4.0).abs() < 1e-12, "{fused:?}");
    }
}

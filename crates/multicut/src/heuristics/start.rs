//! Start solutions of kernels.

use super::greedy::{Preference, contractions};
use super::kernighan_lin::kernighan_lin_with_joins;
use super::local_search::{LARGE, Polish, fuse};
use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;

/// Number of edges up to which Kernighan-Lin also starts from a single cluster. Splitting that repeatedly is slow.
const SMALL: usize = 10_000;

static PREFERENCES: [Preference; 3] = [Preference::Age, Preference::Degree, Preference::Balance];

/// The preferences to contract a kernel with: one only if it is large.
fn preferences(large: bool) -> &'static [Preference] {
    if large { &PREFERENCES[..1] } else { &PREFERENCES }
}

/// A solution of a kernel by contraction, or by bisection if this is better. It is no worse than joining everything, whenever
/// a limit ends it. In kernels that are not large, the best of several solutions, fused with the others by contracting again.
pub(crate) fn contract(graph: &SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let large = graph.edges().count() > LARGE;
    let mut found =
        contractions(graph, preferences(large), budget).into_iter().take(if large { 1 } else { usize::MAX });
    let mut best = found.next().unwrap_or_default();
    let mut objective = graph.objective(&best);
    for other in found {
        if budget.is_over() || other.iter().all(|&label| label == 0) {
            continue;
        }
        let fused = fuse(graph, &best, &other, Polish::Moves, budget);
        let value = graph.objective(&fused);
        if value < objective {
            (best, objective) = (fused, value);
        }
    }
    best
}

/// Work, for each edge and in addition, after which [`contract_and_move`] starts nothing new: large kernels take long, and
/// gain little from more than the best two solutions.
const MOVING: (u64, u64) = (200, 1_000_000);
const MOVING_IN_LARGE: u64 = 40;

/// A solution of a kernel: contractions, Kernighan-Lin with joins from each, and fusions of the best with the others. Starts
/// with the best contraction, and continues with as many others as the work limit allows.
pub(crate) fn contract_and_move(graph: &SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let edges = graph.edges().count();
    let starts = contractions(graph, preferences(edges > LARGE), budget);
    let each = if edges > LARGE { MOVING_IN_LARGE } else { MOVING.0 };
    let end = budget.spent() + each * edges as u64 + MOVING.1;
    let mut best: Option<(f64, Vec<u32>)> = None;
    for mut labels in starts {
        if best.is_some() && (budget.spent() >= end || budget.is_over()) {
            break;
        }
        if best.is_some() && edges > SMALL && labels.iter().all(|&label| label == 0) {
            continue;
        }
        kernighan_lin_with_joins(graph, &mut labels, budget);
        let mut candidates = vec![labels];
        if let Some((_, best)) = &best {
            candidates.push(fuse(graph, best, &candidates[0], Polish::KernighanLin, budget));
        }
        for labels in candidates {
            let objective = graph.objective(&labels);
            if best.as_ref().is_none_or(|best| objective < best.0) {
                best = Some((objective, labels));
            }
        }
    }
    best.map_or_else(|| vec![0; graph.node_count()], |best| best.1)
}

//! Finds violated 2-partition inequalities.

use super::conflict::{Conflict, Parts};
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// Violations up to this value are not worth a row.
const LEAST: f64 = 0.02;

/// Gains below this value are rounding errors.
const NOTHING: f64 = 1e-9;

/// Most inequalities for one centre in one round.
const MOST: usize = 3;

/// For each node, a few violated inequalities [`Parts`] with this node in the smaller set. Heuristic: from each fractional
/// attractive edge of the centre, the larger set grows by the node that gains most; then the smaller set grows while that
/// gains.
///
/// A set is worth `sum (1 - p)` over the edges between the parts, minus `sum p` over those inside, minus the size of the
/// smaller part, and violated where that is positive. `O(d^3)` for a node with `d` fractional attractive edges, at worst.
pub(crate) fn violated(kernel: &Kernel, paid: &[f64], budget: &mut Budget) -> Vec<Conflict> {
    let nodes = kernel.node_count();
    let mut found = Vec::new();
    // Payments at the centre, and gains of candidates.
    let mut kept = vec![0.0; nodes];
    for centre in 0..nodes as u32 {
        if budget.is_over() {
            break;
        }
        let fractional: Vec<u32> = kernel
            .arcs(centre)
            .iter()
            .filter(|&&(_, edge)| {
                let pay = paid[edge as usize];
                kernel.costs[edge as usize] > 0.0 && pay > NOTHING && pay < 1.0 - NOTHING
            })
            .map(|&(node, edge)| {
                kept[node as usize] = 1.0 - paid[edge as usize];
                node
            })
            .collect();
        if fractional.len() < 3 {
            continue;
        }
        let mut here: Vec<(f64, Vec<u32>)> = Vec::new();
        for &start in &fractional {
            let (value, many) = grow(kernel, paid, &fractional, &kept, start, budget);
            if value > LEAST && !here.iter().any(|other| other.1 == many) {
                here.push((value, many));
            }
        }
        here.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (value, many) in here.into_iter().take(MOST) {
            let few = widen(kernel, paid, centre, &many, value);
            found.push(Conflict::Parts(Parts { few, many }));
        }
    }
    found
}

/// The larger set from a start, sorted, and the violation of its inequality.
fn grow(
    kernel: &Kernel,
    paid: &[f64],
    fractional: &[u32],
    kept: &[f64],
    start: u32,
    budget: &mut Budget,
) -> (f64, Vec<u32>) {
    let mut many = vec![start];
    let mut value = kept[start as usize] - 1.0;
    let mut gains: Vec<(u32, f64)> =
        fractional.iter().filter(|&&node| node != start).map(|&node| (node, kept[node as usize])).collect();
    let mut last = start;
    loop {
        budget.spend(gains.len() as u64);
        // Only nodes that repel the whole set stay.
        gains.retain_mut(|(node, gain)| match kernel.edge(*node, last) {
            Some(edge) if kernel.costs[edge as usize] < 0.0 => {
                *gain -= paid[edge as usize].max(0.0);
                *gain > NOTHING
            }
            _ => false,
        });
        let best = gains.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0)));
        let Some((node, gain)) = best else { break };
        gains.retain(|entry| entry.0 != node);
        many.push(node);
        value += gain;
        last = node;
    }
    many.sort_unstable();
    (value, many)
}

/// The smaller set: the centre, and nodes that add to the violation.
fn widen(kernel: &Kernel, paid: &[f64], centre: u32, many: &[u32], mut value: f64) -> Vec<u32> {
    let mut few = vec![centre];
    let candidates: Vec<u32> = kernel
        .arcs(many[0])
        .iter()
        .filter(|arc| kernel.costs[arc.1 as usize] > 0.0)
        .map(|arc| arc.0)
        .collect();
    while few.len() + 1 < many.len() {
        let gain = |&node: &u32| -> Option<(f64, u32)> {
            if few.contains(&node) || many.binary_search(&node).is_ok() {
                return None;
            }
            let mut gain = -1.0;
            for &other in many {
                let edge = kernel.edge(node, other)?;
                if kernel.costs[edge as usize] < 0.0 {
                    return None;
                }
                gain += 1.0 - paid[edge as usize];
            }
            for &other in &few {
                let edge = kernel.edge(node, other)?;
                if kernel.costs[edge as usize] > 0.0 {
                    return None;
                }
                gain -= paid[edge as usize];
            }
            (gain > NOTHING).then_some((gain, node))
        };
        let best = candidates.iter().filter_map(gain).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let Some((gain, node)) = best else { break };
        value += gain;
        few.push(node);
    }
    debug_assert!(value > 0.0);
    few
}

//! Finds violated cycle inequalities where some edges are fixed.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::conflict::Conflict;
use super::cut::Cut;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// Toll for each hop, so that short paths win among equally cheap ones.
const TOLL: f64 = 1e-9;

/// For each edge that repels or is fixed to be cut, the shortest path between its ends over edges that attract or are fixed to
/// be joined, if the inequality is violated by more than `least`.
///
/// `paid` are the payments; `fixed` says of an edge whether it is fixed, and then whether it is paid. One Dijkstra search for
/// each node.
pub(crate) fn violated(
    kernel: &Kernel,
    paid: &[f64],
    fixed: &[Option<bool>],
    least: f64,
    budget: &mut Budget,
) -> Vec<Cut> {
    let attracts = |edge: u32| kernel.costs[edge as usize] > 0.0;
    // Whether an edge belongs to paths, and its length there; otherwise the payment of the edge that closes the cycle.
    let role = |edge: u32| -> (bool, f64) {
        let pay = paid[edge as usize].clamp(0.0, 1.0);
        match (attracts(edge), fixed[edge as usize]) {
            (true, Some(true)) | (false, Some(false)) => (false, 0.0),
            (true, Some(false)) | (false, Some(true)) => (true, 0.0),
            (attractive, None) => (attractive, pay),
        }
    };
    let nodes = kernel.node_count();
    let mut found = Vec::new();
    let (mut distance, mut parent) = (vec![f64::INFINITY; nodes], vec![0u32; nodes]);
    let mut touched: Vec<u32> = Vec::new();
    let mut work = 0;
    for source in 0..nodes as u32 {
        let mut reach = 0.0f64;
        let mut goals = Vec::new();
        for &(node, edge) in kernel.arcs(source) {
            let (path, pay) = role(edge);
            if node > source && !path && pay < 1.0 - least {
                goals.push((node, edge, 1.0 - least - pay));
                reach = reach.max(1.0 - least - pay);
            }
        }
        if goals.is_empty() {
            continue;
        }
        let mut heap = BinaryHeap::from([Reverse((0u64, source))]);
        distance[source as usize] = 0.0;
        touched.push(source);
        while let Some(Reverse((bits, node))) = heap.pop() {
            let length = f64::from_bits(bits);
            if length > distance[node as usize] {
                continue;
            }
            work += kernel.arcs(node).len() as u64;
            for &(other, edge) in kernel.arcs(node) {
                let (path, pay) = role(edge);
                let next = length + pay + TOLL;
                if path && next < reach && next < distance[other as usize] {
                    if distance[other as usize] == f64::INFINITY {
                        touched.push(other);
                    }
                    distance[other as usize] = next;
                    parent[other as usize] = node;
                    heap.push(Reverse((next.to_bits(), other)));
                }
            }
        }
        for (goal, edge, reach) in goals {
            if distance[goal as usize] < reach {
                let mut path = vec![goal];
                let mut node = goal;
                while node != source {
                    node = parent[node as usize];
                    path.push(node);
                }
                let pairs = path.windows(2).filter_map(|pair| kernel.edge(pair[0], pair[1]));
                let conform = !attracts(edge) && pairs.into_iter().all(attracts);
                found.push(if conform { Cut::Conflict(Conflict::Cycle(path)) } else { Cut::Cycle(path) });
            }
        }
        for node in touched.drain(..) {
            distance[node as usize] = f64::INFINITY;
        }
    }
    budget.spend(work);
    found
}

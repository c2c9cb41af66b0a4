//! Recursive bisection along a breadth-first order: a quick start for long graphs.

use std::collections::VecDeque;

use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;

/// Most rounds; each round splits every stretch that gains by it.
const ROUNDS: usize = 100;

/// Gains below this share of the absolute costs are rounding errors.
const TOLERANCE: f64 = 1e-12;

/// Orders the nodes breadth first over attractive edges, from a far node. Cuts this sequence in two where the edges across
/// cost least, nearest to the middle among ties, if that cost is negative. Then cuts each stretch in the same way, by the
/// edges inside it alone. Never worse than joining everything.
///
/// Graphs along a route fall into stretches of the route, as long as this pays, because many different cuts satisfy an edge
/// that repels across a long sequence. Graphs that are no longer than wide gain little.
///
/// `O(n + m)` a round, and as many rounds as stretches are nested: about `log n` if they are even.
pub(crate) fn bisect(graph: &SignedGraph, budget: &mut Budget) -> Vec<u32> {
    let nodes = graph.node_count();
    if nodes == 0 || !budget.spend((nodes + graph.edges().count()) as u64) {
        return vec![0; nodes];
    }
    let far = breadth_first(graph, 0).last().copied().unwrap_or(0);
    let order = breadth_first(graph, far);
    let mut place = vec![0u32; nodes];
    for (at, &node) in order.iter().enumerate() {
        place[node as usize] = at as u32;
    }
    // Edges by the positions of their ends in the sequence.
    let mut edges: Vec<(u32, u32, f64)> = graph
        .edges()
        .map(|(tail, head, cost)| {
            let (tail, head) = (place[tail as usize], place[head as usize]);
            (tail.min(head), tail.max(head), cost)
        })
        .collect();
    let tolerance = TOLERANCE * edges.iter().map(|edge| edge.2.abs()).sum::<f64>();
    let mut stretch = vec![0u32; nodes];
    // Stretches from the last round, in order.
    let mut open = vec![(0u32, nodes as u32)];
    let mut stretches = 1;
    let mut change = vec![0.0; nodes + 1];
    for _ in 0..ROUNDS {
        if open.is_empty() || !budget.spend((nodes + edges.len()) as u64) {
            break;
        }
        change.fill(0.0);
        for &(first, last, cost) in &edges {
            change[first as usize + 1] += cost;
            change[last as usize + 1] -= cost;
        }
        let mut next = Vec::new();
        let mut closed = vec![false; stretches];
        for (start, end) in open {
            let mut across = 0.0;
            let mut best = (-tolerance, u32::MAX, None);
            for cut in start + 1..end {
                across += change[cut as usize];
                let off = (2 * cut).abs_diff(start + end);
                if across < best.0 || (across == best.0 && off < best.1) {
                    best = (across, off, Some(cut));
                }
            }
            if let Some(cut) = best.2 {
                stretch[cut as usize..end as usize].fill(stretches as u32);
                stretches += 1;
                next.extend([(start, cut), (cut, end)]);
            } else {
                closed[stretch[start as usize] as usize] = true;
            }
        }
        closed.resize(stretches, false);
        edges.retain(|&(first, last, _)| {
            let (first, last) = (stretch[first as usize], stretch[last as usize]);
            first == last && !closed[first as usize]
        });
        open = next;
    }
    let labels: Vec<u32> = place.iter().map(|&at| stretch[at as usize]).collect();
    graph.connected_labels(&labels)
}

/// All nodes breadth first over attractive edges, from `start`, and then from each first node that was not reached.
fn breadth_first(graph: &SignedGraph, start: u32) -> Vec<u32> {
    let mut order = Vec::with_capacity(graph.node_count());
    let mut seen = vec![false; graph.node_count()];
    let mut queue = VecDeque::new();
    for source in std::iter::once(start).chain(graph.nodes()) {
        if std::mem::replace(&mut seen[source as usize], true) {
            continue;
        }
        queue.push_back(source);
        while let Some(node) = queue.pop_front() {
            order.push(node);
            for arc in graph.arcs(node).iter().filter(|arc| arc.cost > 0.0) {
                if !std::mem::replace(&mut seen[arc.node as usize], true) {
                    queue.push_back(arc.node);
                }
            }
        }
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_cut_where_that_satisfies_most_repulsion() {
        // A path of twelve nodes with one weak edge, and repulsion across it; numbers are shuffled.
        let name = |at: u32| at * 5 % 12;
        let path = (0..11).map(|at| (name(at), name(at + 1), if at == 6 { 1.0 } else { 2.0 }));
        let across = [(0, 8), (1, 11), (5, 9)].map(|(a, b)| (name(a), name(b), -1.0));
        let graph = SignedGraph::new(12, path.chain(across));
        let labels = bisect(&graph, &mut Budget::new(None, None));
        assert_eq!(graph.objective(&labels), -2.0);
        assert!((0..12).all(|at| (labels[name(at) as usize] == labels[name(0) as usize]) == (at <= 6)));
    }

    #[test]
    fn nothing_is_cut_where_no_cut_pays_and_components_are_told_apart() {
        let graph = SignedGraph::new(4, [(0, 1, 2.0), (2, 3, 2.0), (0, 2, -1.0), (1, 3, -1.0)].into_iter());
        assert_eq!(bisect(&graph, &mut Budget::new(None, None)), [0, 0, 1, 1]);
        let graph = SignedGraph::new(3, [(0, 1, 2.0), (1, 2, 2.0), (0, 2, -1.0)].into_iter());
        assert_eq!(bisect(&graph, &mut Budget::new(None, None)), [0, 0, 0]);
        assert!(bisect(&SignedGraph::new(0, std::iter::empty()), &mut Budget::new(None, None)).is_empty());
    }
}

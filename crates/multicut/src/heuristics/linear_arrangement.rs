//! Local search for short linear arrangements.

use crate::graph::signed_graph::SignedGraph;

/// Farthest that a node moves at once, in positions.
const REACH: usize = 16;

/// Most passes in each direction.
const PASSES: usize = 5;

/// Moves nodes in an order while that lowers the sum over attractive edges of cost times distance in the order (minimum linear
/// arrangement). This sum is the total cost of the attractive edges across each position, so every full break becomes cheap.
///
/// When `u` moves past its right neighbour `v` in the order, the sum changes by `b(v) - b(u)`, with `b` the attraction to the
/// right minus that to the left, without an edge `uv`. Near-linear: each pass visits `REACH` positions a node.
pub(crate) fn shorten(graph: &SignedGraph, order: &mut [u32]) {
    let mut position = vec![0u32; order.len()];
    for (at, &node) in order.iter().enumerate() {
        position[node as usize] = at as u32;
    }
    let mut balance: Vec<f64> =
        graph
            .nodes()
            .map(|node| {
                let arcs = graph.arcs(node).iter().filter(|arc| arc.cost > 0.0);
                arcs.map(|arc| {
                    if position[arc.node as usize] > position[node as usize] { arc.cost } else { -arc.cost }
                })
                .sum()
            })
            .collect();
    let last = order.len().saturating_sub(1);
    for _ in 0..PASSES {
        let mut gained = 0.0;
        for at in (0..order.len()).rev() {
            gained += advance(graph, order, &mut balance, at, |at| (at < last).then(|| at + 1), 1.0);
        }
        for at in 0..order.len() {
            gained += advance(graph, order, &mut balance, at, |at| at.checked_sub(1), -1.0);
        }
        if gained >= -1e-4 * order.len() as f64 {
            break;
        }
    }
}

/// Moves the node at a position to the best one within reach in one direction. Returns the change of the sum.
fn advance(
    graph: &SignedGraph,
    order: &mut [u32],
    balance: &mut [f64],
    at: usize,
    next: impl Fn(usize) -> Option<usize>,
    direction: f64,
) -> f64 {
    let node = order[at];
    let attraction = |other: u32| graph.cost(node, other).max(0.0);
    // Attraction onwards minus attraction backwards.
    let mut ahead = direction * balance[node as usize];
    let (mut change, mut best) = (0.0, (0.0, 0));
    let mut place = at;
    for steps in 1..=REACH {
        let Some(beyond) = next(place) else { break };
        place = beyond;
        let other = order[place];
        let tie = attraction(other);
        change += direction * balance[other as usize] + tie - (ahead - tie);
        ahead -= 2.0 * tie;
        if change < best.0 - 1e-9 {
            best = (change, steps);
        }
    }
    let mut place = at;
    for _ in 0..best.1 {
        let Some(beyond) = next(place) else { break };
        let other = order[beyond];
        let tie = attraction(other);
        balance[other as usize] += 2.0 * direction * tie;
        balance[node as usize] -= 2.0 * direction * tie;
        order[place] = other;
        order[beyond] = node;
        place = beyond;
    }
    best.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shuffled_path_becomes_straight_where_moves_reach() {
        let path = (0..30).map(|at| (at, at + 1, 1.0));
        let graph = SignedGraph::new(31, path.chain([(0, 30, -5.0)]));
        // Every five nodes reversed.
        let mut order: Vec<u32> =
            (0..31).map(|at| if at < 30 { at / 5 * 5 + 4 - at % 5 } else { at }).collect();
        shorten(&graph, &mut order);
        assert!(order.is_sorted() || order.iter().rev().is_sorted(), "{order:?}");
    }

    #[test]
    fn the_reported_change_is_that_of_the_sum() {
        let edges =
            [(0, 3, 1.0), (1, 2, 2.0), (0, 4, 1.0), (2, 4, 1.0), (1, 4, -1.0), (3, 5, 2.0), (0, 1, 3.0)];
        let graph = SignedGraph::new(6, edges.into_iter());
        let at = |order: &[u32], node: u32| order.iter().position(|&other| other == node).unwrap() as f64;
        let length = |order: &[u32]| -> f64 {
            let attractive = graph.edges().filter(|edge| edge.2 > 0.0);
            attractive.map(|(a, b, cost)| cost * (at(order, a) - at(order, b)).abs()).sum()
        };
        let mut moves = 0;
        for start in [[4, 1, 0, 5, 2, 3], [0, 2, 4, 1, 3, 5], [5, 0, 1, 3, 4, 2]] {
            for position in 0..6 {
                for direction in [1.0, -1.0] {
                    let mut order = start;
                    let mut balance: Vec<f64> = (0..6).map(|node| balance_of(&graph, &order, node)).collect();
                    let next = |at: usize| {
                        if direction > 0.0 { (at < 5).then(|| at + 1) } else { at.checked_sub(1) }
                    };
                    let change = advance(&graph, &mut order, &mut balance, position, next, direction);
                    assert_eq!(length(&order) - length(&start), change, "{order:?} from {start:?}");
                    let expected: Vec<f64> = (0..6).map(|node| balance_of(&graph, &order, node)).collect();
                    assert_eq!(balance, expected);
                    moves += usize::from(change < 0.0);
                }
            }
        }
        assert!(moves > 5);
    }

    /// Attraction to the right minus that to the left, by the definition.
    fn balance_of(graph: &SignedGraph, order: &[u32], node: u32) -> f64 {
        let at = |node: u32| order.iter().position(|&other| other == node);
        let arcs = graph.arcs(node).iter().filter(|arc| arc.cost > 0.0);
        arcs.map(|arc| if at(arc.node) > at(node) { arc.cost } else { -arc.cost }).sum()
    }
}

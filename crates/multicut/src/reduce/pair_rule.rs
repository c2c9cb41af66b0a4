//! The rule of pairs: attractive edges whose ends are together in some optimum.

use crate::budget::Budget;
use crate::graph::signed_graph::{Arc, SignedGraph};

/// Shares of the three moves of a pair `uv` in an average: `v` to `u`, `u` to `v`, and both to a cluster of their own.
pub(crate) type Shares = [f64; 3];

/// Most evaluations for one edge. Eight find nearly all shares that there are.
const EVALUATIONS: usize = 12;

/// Most neighbours of one end for each neighbour of the other, and in addition. A pair of very different degrees is rarely
/// contracted, except by dominance, and a hub would be walked for each of its neighbours.
const UNLIKE: (usize, usize) = (4, 64);

/// Shares for which the rule of pairs contracts the edge from `node`, which is `u` below; `total` is the sum of the absolute
/// costs there.
///
/// Take an optimum with `u` in a cluster with the nodes `A` besides, and `v` in another with `B`. The three moves gain
///
/// * `v` to `u`: `c_uv + c_v(A) - c_v(B)`,
/// * `u` to `v`: `c_uv + c_u(B) - c_u(A)`,
/// * both to a new cluster: `c_uv - c_u(A) - c_v(B)`.
///
/// The average of these gains with shares `s` (not negative, of sum 1) is `c_uv` minus the sum of one term for each other node
/// `w`: `(s_1 + s_2) c_uw - s_0 c_vw` if `w` is in `A`, `(s_0 + s_2) c_vw - s_1 c_uw` if it is in `B`, and 0 elsewhere. Let the
/// *loss* be the sum of the largest of these three values, with cost 0 where there is no edge. If it is at most `c_uv`, the
/// average is not negative, so at least one move does not cost, and some optimum joins `u` and `v`.
///
/// Shares (1, 0, 0) give dominance, and (0, 0, 1) join an edge that outweighs all other attraction at its ends. Shares
/// (1/2, 1/2, 0) join nodes whose costs to all others are similar. If the costs are equal, these are critical cliques of
/// cluster editing (Guo, Theor. Comput. Sci. 410, 2009). Where such nodes were contracted before, the costs are multiples of
/// each other, and shares in this proportion join them.
///
/// The loss is convex in the shares. A linear function below it, which it touches at one point, therefore rules out all shares
/// where it exceeds `c_uv`: they are cut from a polygon of possible shares, whose centre is tried next (a cutting-plane method of
/// centres; Levin, Soviet Math. Doklady 6, 1965). An evaluation is linear in the degrees, which must be similar.
pub(super) fn shares(
    graph: &SignedGraph,
    node: u32,
    total: f64,
    edge: &Arc,
    budget: &mut Budget,
) -> Option<Shares> {
    let degrees = [graph.arcs(node).len(), graph.arcs(edge.node).len()];
    let (fewer, more) = (degrees[0].min(degrees[1]), degrees[0].max(degrees[1]));
    if more > UNLIKE.0 * fewer + UNLIKE.1 {
        return None;
    }
    let other: f64 = graph.arcs(edge.node).iter().map(|arc| arc.cost.abs()).sum();
    let alike = [total / (total + other), other / (total + other), 0.0];
    let apart = [0.0, 0.0, 1.0];
    let mut polygon = vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], apart];
    for evaluation in 0..EVALUATIONS {
        let shares = match evaluation {
            0 => alike,
            1 => apart,
            _ => centre(&polygon)?,
        };
        let losses = losses(graph, node, edge, &shares, budget)?;
        if dot(&losses, &shares) <= edge.cost {
            return Some(shares);
        }
        polygon = clipped(&polygon, |corner| dot(&losses, corner) - edge.cost);
    }
    None
}

/// What each of the three moves loses if all other nodes are where the average loss is largest, so that the loss is at least the
/// average of the three values for any other shares. `None` if some of these nodes make each move lose more than the edge
/// costs, which rules out all shares.
fn losses(
    graph: &SignedGraph,
    node: u32,
    edge: &Arc,
    shares: &Shares,
    budget: &mut Budget,
) -> Option<[f64; 3]> {
    let (mut at_u, mut at_v) = (graph.arcs(node), graph.arcs(edge.node));
    let mut losses = [0.0; 3];
    let mut visited = 0;
    while let Some((other, u, v)) = next_common(&mut at_u, &mut at_v) {
        visited += 1;
        if other == node || other == edge.node {
            continue;
        }
        let (in_a, in_b) = ([-v, u, u], [v, -u, v]);
        let (near_u, near_v) = (dot(&in_a, shares), dot(&in_b, shares));
        if near_u.max(near_v) <= 0.0 {
            continue;
        }
        let worst = if near_u >= near_v { in_a } else { in_b };
        for (loss, more) in losses.iter_mut().zip(worst) {
            *loss += more;
        }
        if losses.iter().all(|loss| *loss > edge.cost) {
            break;
        }
    }
    budget.spend(visited);
    losses.iter().any(|loss| *loss <= edge.cost).then_some(losses)
}

/// The next neighbour of either node, and its costs, 0 where there is no edge.
fn next_common(at_u: &mut &[Arc], at_v: &mut &[Arc]) -> Option<(u32, f64, f64)> {
    let first = |arcs: &[Arc]| arcs.first().map(|arc| arc.node);
    let node = first(at_u).into_iter().chain(first(at_v)).min()?;
    let take = |arcs: &mut &[Arc]| match *arcs {
        [arc, rest @ ..] if arc.node == node => {
            *arcs = rest;
            arc.cost
        }
        _ => 0.0,
    };
    Some((node, take(at_u), take(at_v)))
}

/// The mean of the corners; `None` if there are none.
fn centre(polygon: &[Shares]) -> Option<Shares> {
    let sum =
        polygon.iter().copied().reduce(|sum, corner| [0, 1, 2].map(|place| sum[place] + corner[place]))?;
    Some(sum.map(|sum| sum / polygon.len() as f64))
}

/// The part of a convex polygon where a linear function is 0 or less.
fn clipped(polygon: &[Shares], value: impl Fn(&Shares) -> f64) -> Vec<Shares> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (place, corner) in polygon.iter().enumerate() {
        let next = &polygon[(place + 1) % polygon.len()];
        let (here, there) = (value(corner), value(next));
        if here <= 0.0 {
            kept.push(*corner);
        }
        if here * there < 0.0 {
            let along = here / (here - there);
            kept.push([0, 1, 2].map(|place| corner[place] + along * (next[place] - corner[place])));
        }
    }
    kept
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// The shares for the edge between nodes 0 and 1.
    fn shares_of(nodes: usize, edges: &[(u32, u32, f64)]) -> Option<Shares> {
        let graph = SignedGraph::new(nodes, edges.iter().copied());
        let edge = *graph.arcs(0).iter().find(|arc| arc.node == 1)?;
        let total = graph.arcs(0).iter().map(|arc| arc.cost.abs()).sum();
        shares(&graph, 0, total, &edge, &mut Budget::new(None, None))
    }

    #[test]
    fn a_pair_that_outweighs_other_attraction_is_joined_however_much_it_repels() {
        let at_most = |attraction: f64| {
            shares_of(4, &[(0, 1, 2.0), (0, 2, attraction), (0, 3, -9.0), (1, 3, 1.0), (1, 2, -9.0)])
        };
        assert_eq!(at_most(1.0), Some([0.0, 0.0, 1.0]));
        assert_eq!(at_most(1.1), None);
    }

    #[test]
    fn nodes_whose_costs_are_multiples_are_joined() {
        // Node 1 is like three copies of node 0. The edge between them is weaker than all that dominance or triangles need.
        let edges: Vec<_> = (2..8u32)
            .flat_map(|other| {
                let cost = if other % 2 == 0 { 5.0 } else { -4.0 };
                [(0, other, cost), (1, other, 3.0 * cost)]
            })
            .chain([(0, 1, 0.01)])
            .collect();
        let [to_u, to_v, out] = shares_of(8, &edges).unwrap();
        assert!((to_u - 0.25).abs() < 1e-3 && (to_v - 0.75).abs() < 1e-3 && out == 0.0);
    }

    #[test]
    fn a_hub_is_not_walked_for_each_of_its_neighbours() {
        let spokes = (1..=5000u32).map(|node| (0, node, 1.0));
        let rim = (1..5000u32).map(|node| (node, node + 1, -1.0));
        let graph = SignedGraph::new(5001, spokes.chain(rim));
        let mut budget = Budget::new(None, None);
        for arc in graph.arcs(0) {
            assert_eq!(shares(&graph, 0, 5000.0, arc, &mut budget), None);
        }
        assert!(budget.spent() < 100_000, "{}", budget.spent());
    }

    /// The gains of the three moves if each other node is in `A` (0), in `B` (1), or elsewhere (2).
    fn gains(costs: &[[f64; 2]], edge: f64, places: &[usize]) -> [f64; 3] {
        let sum = |end: usize, place: usize| -> f64 {
            costs.iter().zip(places).filter(|entry| *entry.1 == place).map(|entry| entry.0[end]).sum()
        };
        let (at_u, at_v) = ([sum(0, 0), sum(0, 1)], [sum(1, 0), sum(1, 1)]);
        [edge + at_v[0] - at_v[1], edge + at_u[1] - at_u[0], edge - at_u[0] - at_v[1]]
    }

    #[test]
    fn shares_are_found_if_and_only_if_no_placement_makes_the_average_negative() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let mut found = 0;
        for _ in 0..2000 {
            let others = random.random_range(1..6u32);
            let costs: Vec<[f64; 2]> =
                (0..others).map(|_| [0, 1].map(|_| f64::from(random.random_range(-4..5)))).collect();
            let edge = f64::from(random.random_range(1..9));
            let to_others = costs.iter().zip(2..).flat_map(|(cost, at)| [(0, at, cost[0]), (1, at, cost[1])]);
            let edges: Vec<_> = to_others.chain([(0, 1, edge)]).collect();
            let codes = 0..3usize.pow(others);
            let placements = codes.map(|code| (0..others).map(move |at| code / 3usize.pow(at) % 3).collect());
            let all: Vec<[f64; 3]> =
                placements.map(|places: Vec<usize>| gains(&costs, edge, &places)).collect();
            let least =
                |shares: &Shares| all.iter().map(|gains| dot(gains, shares)).fold(f64::INFINITY, f64::min);
            if let Some(shares) = shares_of(2 + others as usize, &edges) {
                found += 1;
                assert!(least(&shares) >= -1e-9, "{costs:?} {edge}");
                continue;
            }
            let grid = (0..=8).flat_map(|first| (0..=8 - first).map(move |second| [first, second]));
            for [first, second] in grid {
                let shares = [first, second, 8 - first - second].map(|part| f64::from(part) / 8.0);
                assert!(least(&shares) < 1e-9, "{costs:?} {edge}");
            }
        }
        assert!((300..1700).contains(&found), "{found}");
    }
}

//! An order of nodes along bands.

use crate::graph::signed_graph::SignedGraph;

/// Rounds of averaging.
const ROUNDS: usize = 30;

/// Largest difference in depth between the ends of a weak tie that continues the route.
const NEAR: u32 = 12;

/// Orders the nodes along the attractive edges, so that the nodes of a band are in the order of the route.
///
/// A band is many edges wide, so its edges are on cycles of three or four attractive edges. Edges on no such cycle are left
/// out: a few of them between far viewpoints would fold the order, and the rest hardly matters. Each component of the other
/// edges is ordered by distance from its far end, averaged over neighbours; components follow each other by first node.
///
/// `O(m d^2 + n log n)` at degree `d`, less where edges are on many cycles.
pub(crate) fn band_order(graph: &SignedGraph) -> Vec<u32> {
    let sturdy = sturdy_neighbours(graph);
    let (depth, component, mut order) = layers(graph, &sturdy);
    // The last depth of each component, by the name of its component.
    let mut last = vec![0u32; graph.node_count()];
    for &node in &order {
        let last = &mut last[component[node as usize] as usize];
        *last = depth[node as usize].max(*last);
    }
    // A weak tie holds where it continues the route: between near nodes, or between ends of components.
    let near_end = |node: u32| {
        let (depth, last) = (depth[node as usize], last[component[node as usize] as usize]);
        depth <= NEAR || depth + NEAR >= last
    };
    let continues = |tail: u32, head: u32| {
        if component[tail as usize] == component[head as usize] {
            depth[tail as usize].abs_diff(depth[head as usize]) <= NEAR
        } else {
            near_end(tail) && near_end(head)
        }
    };
    let near = Neighbours::new(graph, continues);
    let (depth, mut component, joined) = layers(graph, &near);
    order = joined;
    let mut at: Vec<f64> = depth.iter().map(|&depth| f64::from(depth)).collect();
    for _ in 0..ROUNDS {
        at = graph
            .nodes()
            .map(|node| {
                let row = near.row(node);
                let sum: f64 = row.iter().map(|&other| at[other as usize]).sum();
                (sum + at[node as usize]) / (row.len() + 1) as f64
            })
            .collect();
    }
    attach(graph, &mut component, &mut at, &mut order);
    order.sort_by(|&a, &b| {
        let key = |node: u32| (component[node as usize], at[node as usize]);
        let (a, b) = (key(a), key(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    order
}

/// The nodes with neighbours, breadth first from the far end of each component, with their depths and the first node of their
/// component. Other nodes are their own components at depth 0.
fn layers(graph: &SignedGraph, near: &Neighbours) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let nodes = graph.node_count();
    let mut depth = vec![u32::MAX; nodes];
    let mut order = Vec::with_capacity(nodes);
    let mut component: Vec<u32> = graph.nodes().collect();
    for source in graph.nodes() {
        if depth[source as usize] != u32::MAX {
            continue;
        }
        if near.row(source).is_empty() {
            depth[source as usize] = 0;
            continue;
        }
        let mut sweep = Vec::new();
        breadth_first(near, source, &mut depth, &mut sweep);
        let far = sweep.last().copied().unwrap_or(source);
        for node in sweep.drain(..) {
            depth[node as usize] = u32::MAX;
        }
        breadth_first(near, far, &mut depth, &mut sweep);
        for &node in &sweep {
            component[node as usize] = source;
        }
        order.extend(sweep);
    }
    (depth, component, order)
}

/// Gives the remaining nodes the position of a neighbour, breadth first.
fn attach(graph: &SignedGraph, component: &mut [u32], at: &mut [f64], order: &mut Vec<u32>) {
    let mut seen = vec![false; graph.node_count()];
    for &node in order.iter() {
        seen[node as usize] = true;
    }
    let mut next = 0;
    for source in graph.nodes() {
        while let Some(&node) = order.get(next) {
            next += 1;
            for arc in graph.arcs(node).iter().filter(|arc| arc.cost > 0.0) {
                if !std::mem::replace(&mut seen[arc.node as usize], true) {
                    component[arc.node as usize] = component[node as usize];
                    at[arc.node as usize] = at[node as usize];
                    order.push(arc.node);
                }
            }
        }
        if !std::mem::replace(&mut seen[source as usize], true) {
            component[source as usize] = source;
            at[source as usize] = 0.0;
            order.push(source);
        }
    }
}

/// Neighbours in compressed rows.
struct Neighbours {
    starts: Vec<u32>,
    nodes: Vec<u32>,
}

impl Neighbours {
    /// The neighbours over attractive edges for which `keep` holds.
    fn new(graph: &SignedGraph, keep: impl Fn(u32, u32) -> bool) -> Self {
        let mut near = Self { starts: vec![0], nodes: Vec::new() };
        for node in graph.nodes() {
            let arcs = graph.arcs(node).iter().filter(|arc| arc.cost > 0.0 && keep(node, arc.node));
            near.nodes.extend(arcs.map(|arc| arc.node));
            near.starts.push(near.nodes.len() as u32);
        }
        near
    }

    fn row(&self, node: u32) -> &[u32] {
        &self.nodes[self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize]
    }
}

/// The neighbours over attractive edges that are on a cycle of three or four of them.
fn sturdy_neighbours(graph: &SignedGraph) -> Neighbours {
    let attractive = |node: u32| graph.arcs(node).iter().filter(|arc| arc.cost > 0.0).map(|arc| arc.node);
    let mut near = Neighbours { starts: vec![0], nodes: Vec::new() };
    let mut mark = vec![u32::MAX; graph.node_count()];
    for node in graph.nodes() {
        for other in attractive(node) {
            mark[other as usize] = node;
        }
        // From the edge's other end one or two steps back to a neighbour.
        let sturdy = |other: u32| {
            attractive(other).any(|one| {
                mark[one as usize] == node
                    || (one != node && attractive(one).any(|two| two != other && mark[two as usize] == node))
            })
        };
        near.nodes.extend(attractive(node).filter(|&other| sturdy(other)));
        near.starts.push(near.nodes.len() as u32);
    }
    near
}

fn breadth_first(near: &Neighbours, start: u32, depth: &mut [u32], order: &mut Vec<u32>) {
    depth[start as usize] = 0;
    order.push(start);
    let mut next = order.len() - 1;
    while let Some(&node) = order.get(next) {
        next += 1;
        for &other in near.row(node) {
            if depth[other as usize] == u32::MAX {
                depth[other as usize] = depth[node as usize] + 1;
                order.push(other);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_false_pair_does_not_fold_the_route() {
        // A band of 200 nodes, each tied to the next three, and two weak ties from one third to another.
        let band = (0..200u32).flat_map(|at| (1..=3).map(move |step| (at, at + step, 1.0)));
        let edges = band.filter(|edge| edge.1 < 200).chain([(40, 150, 1.0), (41, 157, 1.0)]);
        let graph = SignedGraph::new(200, edges);
        let order = band_order(&graph);
        let at = |node: u32| order.iter().position(|&other| other == node).unwrap() as i64;
        let direction = (at(199) - at(0)).signum();
        for node in 0..200 {
            let expected = if direction > 0 { i64::from(node) } else { 199 - i64::from(node) };
            assert!((at(node) - expected).abs() <= 4, "{order:?}");
        }
    }
}

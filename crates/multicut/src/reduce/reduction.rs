//! Reductions that keep the optimum.
//!
//! Costs `c > 0` attract; `S(u)` is the sum of `|c|` over the edges at `u`. After each rule below, some optimal multicut of
//! the old graph follows from any optimal multicut of the new one.
//!
//! * **No attraction.** A node without attractive edges is alone in some optimum, because removing it from its cluster never
//!   costs. Its edges leave the graph.
//! * **Degree 1** with attraction: joining it costs nothing and breaks no cycle. Contract.
//! * **Degree 2**, neighbours `x`, `y`, costs `a`, `b`: given the rest, the node joins one neighbour's cluster, or none.
//!   If `x` and `y` are joined, its best cost is `min(0, a + b)`; if they are apart, `min(a, b, a + b)`. So the node leaves, the
//!   constant rises by the first value, and the cost of `xy` by the difference.
//! * **Dominance** (Lange, Karrenbauer, Andres, ICML 2018; single-node cut): if `c_uv >= S(u) - c_uv`, moving `u` from its
//!   cluster to that of `v` never costs more than the gain `c_uv`. Contract `uv`.
//! * **Triangle** (after Lange, Andres, Swoboda, CVPR 2019): `uv`, `uw`, `vw` attractive, `r_u = S(u) - c_uv - c_uw`,
//!   `r_v = S(v) - c_uv - c_vw`. Take an optimum with `u` and `v` apart. If `w` is with `v`, moving `u` to both gains
//!   `c_uv + c_uw` and loses at most `r_u`. If `w` is with `u`, the same holds for `v`. If all three are apart, moving `u` to `v`
//!   gains at least `c_uv - r_u` (the cost of `uw` is still paid), moving `v` to `u` at least `c_uv - r_v`, and moving both `u`
//!   and `v` to `w` at least `c_uv + c_uw + c_vw - r_u - r_v`. So `uv` may be contracted if `c_uv + c_uw >= r_u`,
//!   `c_uv + c_vw >= r_v`, and one of the last three gains is not negative. Without that last condition, the rule holds for cuts
//!   into two clusters, but not for multicuts.
//! * **Pairs**: contracts `uv` if joining it never costs on average over three moves ([`pair_rule`](super::pair_rule)).
//!
//! Rules run to a fixpoint from a queue of nodes whose edges changed.

use std::collections::VecDeque;

use super::pair_rule::{self, Shares};
use crate::budget::Budget;
use crate::graph::signed_graph::SignedGraph;
use crate::graph::union_find::UnionFind;

/// An eliminated node. Eliminations are undone in reverse order to extend a solution; nodes have the caller's names.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DegreeTwo {
    pub(crate) node: u32,
    pub(crate) neighbours: [u32; 2],
    pub(crate) costs: [f64; 2],
}

/// A step of a reduction, with the caller's names of nodes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Step {
    /// `gone` was merged into `kept` by dominance (of either end) or because it had no other edge.
    Dominance { kept: u32, gone: u32 },
    /// The same by the triangle rule with `apex`.
    Triangle { kept: u32, gone: u32, apex: u32 },
    /// The same by the rule of pairs. The first share is that of moving `gone` to `kept`.
    Pair { kept: u32, gone: u32, shares: Shares },
    /// A node of degree two was eliminated.
    DegreeTwo { node: u32 },
    /// A node without attraction was isolated.
    Isolate { node: u32 },
}

/// Largest graph, in edges, to which the rule of pairs is applied: in huge bands it contracts one edge in a hundred, and costs
/// more than it saves.
const PAIRED: usize = 1_000_000;

/// Records the changes that reductions make, with the caller's names of nodes.
#[derive(Debug)]
pub(crate) struct History<'a> {
    pub(crate) joined: &'a mut UnionFind,
    pub(crate) undo: &'a mut Vec<DegreeTwo>,
    /// The steps, if a certificate is wanted.
    pub(crate) steps: Option<&'a mut Vec<Step>>,
}

impl History<'_> {
    fn step(&mut self, step: Step) {
        if let Some(steps) = &mut self.steps {
            steps.push(step);
        }
    }
}

/// Undoes the degree-two eliminations: `joined` then holds a multicut of the graph before them.
pub(crate) fn lift(joined: &mut UnionFind, undo: &[DegreeTwo]) {
    for &DegreeTwo { node, neighbours: [x, y], costs: [a, b] } in undo.iter().rev() {
        if joined.find(x) == joined.find(y) {
            if a + b > 0.0 {
                joined.union(node, x);
            }
        } else if a.max(b) > 0.0 {
            // Apart: join the neighbour that attracts more. Being alone costs at least as much.
            joined.union(node, if a >= b { x } else { y });
        }
    }
}

/// Reduces `graph` by the node and edge rules until none applies. `names` are its nodes in the caller's graph. Adds costs
/// that leave the objective to `constant`. Returns whether anything changed.
///
/// Linear for bounded degrees: a node is visited again only when its edges changed.
pub(crate) fn reduce(
    graph: &mut SignedGraph,
    names: &[u32],
    constant: &mut f64,
    history: &mut History,
    budget: &mut Budget,
) -> bool {
    let mut changed = false;
    let mut queue = Queue::new(graph.node_count());
    let paired = graph.edges().count() <= PAIRED;
    while let Some(node) = queue.pop() {
        if !budget.spend(1 + graph.arcs(node).len() as u64) {
            break;
        }
        let arcs = graph.arcs(node);
        if arcs.is_empty() {
            continue;
        }
        if arcs.iter().all(|arc| arc.cost < 0.0) {
            changed = true;
            history.step(Step::Isolate { node: names[node as usize] });
            for arc in graph.detach(node) {
                *constant += arc.cost;
                queue.push(arc.node);
            }
            continue;
        }
        if let [x, y] = *arcs {
            changed = true;
            let (a, b) = (x.cost, y.cost);
            let joined = (a + b).min(0.0);
            let apart = a.min(b).min(a + b);
            *constant += joined;
            graph.detach(node);
            graph.add_cost(x.node, y.node, apart - joined);
            let name = names[node as usize];
            let neighbours = [names[x.node as usize], names[y.node as usize]];
            history.undo.push(DegreeTwo { node: name, neighbours, costs: [a, b] });
            history.step(Step::DegreeTwo { node: name });
            queue.push(x.node);
            queue.push(y.node);
            continue;
        }
        if let Some((other, rule)) = contractible(graph, node, paired, budget) {
            changed = true;
            let (kept, gone, arcs) = graph.contract(node, other);
            let (kept_name, gone_name) = (names[kept as usize], names[gone as usize]);
            history.joined.union(kept_name, gone_name);
            history.step(match rule {
                Rule::Dominance => Step::Dominance { kept: kept_name, gone: gone_name },
                Rule::Triangle(apex) => {
                    Step::Triangle { kept: kept_name, gone: gone_name, apex: names[apex as usize] }
                }
                Rule::Pair([to_node, to_other, out]) => {
                    let shares =
                        if kept == node { [to_node, to_other, out] } else { [to_other, to_node, out] };
                    Step::Pair { kept: kept_name, gone: gone_name, shares }
                }
            });
            queue.push(kept);
            for arc in arcs {
                queue.push(arc.node);
            }
        }
    }
    changed
}

/// A rule that contracts an edge.
enum Rule {
    Dominance,
    /// With this apex.
    Triangle(u32),
    Pair(Shares),
}

/// A neighbour to which `node` may be contracted, and the rule that permits it; the rule of pairs only if `paired`.
fn contractible(graph: &SignedGraph, node: u32, paired: bool, budget: &mut Budget) -> Option<(u32, Rule)> {
    let arcs = graph.arcs(node);
    let total: f64 = arcs.iter().map(|arc| arc.cost.abs()).sum();
    let mut largest = arcs[0];
    for &arc in &arcs[1..] {
        if arc.cost > largest.cost {
            largest = arc;
        }
    }
    if 2.0 * largest.cost >= total {
        return Some((largest.node, Rule::Dominance));
    }
    // c_uv + c_uw >= r_u requires that twice the two largest costs reach S(u), which rules out hubs at once.
    for arc in arcs {
        if arc.cost <= 0.0 || 2.0 * (arc.cost + largest.cost) < total {
            continue;
        }
        if let Some(apex) = triangle(graph, node, arc.node, total, budget) {
            return Some((arc.node, Rule::Triangle(apex)));
        }
    }
    arcs.iter().filter(|arc| paired && arc.cost > 0.0).find_map(|arc| {
        let shares = pair_rule::shares(graph, node, total, arc, budget)?;
        Some((arc.node, Rule::Pair(shares)))
    })
}

/// An apex for which the triangle rule contracts `uv`.
fn triangle(graph: &SignedGraph, u: u32, v: u32, total_u: f64, budget: &mut Budget) -> Option<u32> {
    let cost = graph.cost(u, v);
    let (at_u, at_v) = (graph.arcs(u), graph.arcs(v));
    budget.spend((at_u.len() + at_v.len()) as u64);
    let total_v: f64 = at_v.iter().map(|arc| arc.cost.abs()).sum();
    let mut position = 0;
    for arc in at_u {
        if arc.cost <= 0.0 || 2.0 * (cost + arc.cost) < total_u {
            continue;
        }
        position += at_v[position..].partition_point(|other| other.node < arc.node);
        let other = at_v.get(position)?;
        if other.node != arc.node || other.cost <= 0.0 {
            continue;
        }
        let rest_u = total_u - cost - arc.cost;
        let rest_v = total_v - cost - other.cost;
        let near = cost + arc.cost >= rest_u && cost + other.cost >= rest_v;
        let apart = cost >= rest_u || cost >= rest_v || cost + arc.cost + other.cost >= rest_u + rest_v;
        if near && apart {
            return Some(arc.node);
        }
    }
    None
}

/// A queue, first in, first out, that holds each node at most once: changes to a hub accumulate while its neighbours are
/// processed.
struct Queue {
    nodes: VecDeque<u32>,
    waiting: Vec<bool>,
}

impl Queue {
    fn new(node_count: usize) -> Self {
        Self { nodes: (0..node_count as u32).collect(), waiting: vec![true; node_count] }
    }

    fn push(&mut self, node: u32) {
        if !std::mem::replace(&mut self.waiting[node as usize], true) {
            self.nodes.push_back(node);
        }
    }

    fn pop(&mut self) -> Option<u32> {
        let node = self.nodes.pop_front()?;
        self.waiting[node as usize] = false;
        Some(node)
    }
}

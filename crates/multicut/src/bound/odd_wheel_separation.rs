//! Finds violated odd wheel inequalities.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::conflict::{Conflict, Wheel};
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// Violations up to this value are not worth a row.
const LEAST: f64 = 0.02;

/// Distances within this difference of 0 or 1 count as 0 or 1.
const NEAR: f64 = 1e-3;

/// Most wheels around one centre that are added in one round.
const MOST: usize = 4;

/// Work of one round.
const EFFORT: u64 = 50_000_000;

/// Toll for each hop, so that short walks win among equally cheap ones.
const TOLL: f64 = 1e-9;

/// Separation by shortest walks of odd parity.
///
/// Let `d(v)` be the distance of `v` from a centre over attractive edges, in payments. Give a repulsive edge `v w` the length
/// `(1 - y) + (d(v) + d(w) - 1) / 2`, and an attractive edge passed from `v` to `w` the length `y + (d(w) - d(v)) / 2`. Where
/// no conflicted cycle is violated, no length is negative: the former because `d(v) + d(w) + (1 - y) >= 1`, the latter
/// because distances differ by at most the length of an edge. Along a closed walk with `k` repulsive edges, the halves add up
/// to the spokes. So the length of the walk is the payment of the wheel minus `k / 2`, and the wheel is violated if and only
/// if `k` is odd and the length is below 1/2. The search runs over nodes and parities (after Deza, Groetschel, Laurent 1992,
/// for wheels with single edges), and leaves out nodes at distance 1 or more.
///
/// In a violated wheel, the walk enters some repulsive edge at a node with a distance strictly between 0 and 1. If all of
/// these distances were 0, or 1 or more, the proof at [`Wheel`] would hold. So only such nodes can start a walk.
pub(crate) struct WheelSeparation<'a> {
    kernel: &'a Kernel,
    /// Distance from the centre if less than 1, else infinite, and the previous node on the shortest path.
    radius: Vec<f64>,
    inward: Vec<u32>,
    ball: Vec<u32>,
    /// Whether walks from a node have been searched.
    done: Vec<bool>,
    /// Shortest length by state: twice the node plus the parity.
    length: Vec<f64>,
    previous: Vec<u32>,
    touched: Vec<u32>,
}

impl<'a> WheelSeparation<'a> {
    pub(crate) fn new(kernel: &'a Kernel) -> Self {
        let nodes = kernel.node_count();
        Self {
            kernel,
            radius: vec![f64::INFINITY; nodes],
            inward: vec![0; nodes],
            ball: Vec::new(),
            done: vec![false; nodes],
            length: vec![f64::INFINITY; 2 * nodes],
            previous: vec![0; 2 * nodes],
            touched: Vec::new(),
        }
    }

    /// Violated wheels at a point that violates no cycle inequality: a few around each node. Of nodes at distance 0 from each
    /// other, only one is a centre.
    ///
    /// At worst one shortest path search for each pair of nodes less than 1 apart; ends when its work is used up.
    pub(crate) fn violated(&mut self, paid: &[f64], budget: &mut Budget) -> Vec<Conflict> {
        let end = budget.spent().saturating_add(EFFORT);
        let mut found = Vec::new();
        let mut met = vec![false; self.kernel.node_count()];
        for centre in 0..self.kernel.node_count() as u32 {
            if budget.is_over() || budget.spent() > end {
                break;
            }
            if met[centre as usize] {
                continue;
            }
            self.grow(centre, paid, budget);
            for &node in &self.ball {
                met[node as usize] |= self.radius[node as usize] < NEAR;
            }
            self.around(centre, paid, end, &mut found, budget);
            for node in self.ball.drain(..) {
                self.radius[node as usize] = f64::INFINITY;
                self.done[node as usize] = false;
            }
        }
        found
    }

    fn around(
        &mut self,
        centre: u32,
        paid: &[f64],
        end: u64,
        found: &mut Vec<Conflict>,
        budget: &mut Budget,
    ) {
        let most = found.len() + MOST;
        for index in 0..self.ball.len() {
            let start = self.ball[index];
            let radius = self.radius[start as usize];
            let repels = |&(node, edge): &(u32, u32)| {
                self.kernel.costs[edge as usize] < 0.0 && self.radius[node as usize].is_finite()
            };
            if !(NEAR..=1.0 - NEAR).contains(&radius) || !self.kernel.arcs(start).iter().any(repels) {
                continue;
            }
            if let Some(rim) = self.odd_walk(start, paid, budget) {
                let wheel = Conflict::Wheel(self.wheel(centre, rim));
                let uses = wheel.uses(self.kernel);
                let value: f64 =
                    uses.iter().map(|&(edge, times)| f64::from(times) * paid[edge as usize]).sum();
                if value < wheel.least() - LEAST {
                    found.push(wheel);
                }
            }
            self.done[start as usize] = true;
            if found.len() >= most || budget.is_over() || budget.spent() > end {
                return;
            }
        }
    }

    /// Distances from a centre over attractive edges.
    fn grow(&mut self, centre: u32, paid: &[f64], budget: &mut Budget) {
        let mut heap = BinaryHeap::from([Reverse((0u64, centre))]);
        self.radius[centre as usize] = 0.0;
        self.ball.push(centre);
        let mut work = 0;
        while let Some(Reverse((bits, node))) = heap.pop() {
            let radius = f64::from_bits(bits);
            if radius > self.radius[node as usize] {
                continue;
            }
            work += self.kernel.arcs(node).len() as u64;
            for &(other, edge) in self.kernel.arcs(node) {
                let next = radius + paid[edge as usize].max(0.0) + TOLL;
                if self.kernel.costs[edge as usize] > 0.0 && next < self.radius[other as usize].min(1.0) {
                    if self.radius[other as usize].is_infinite() {
                        self.ball.push(other);
                    }
                    self.radius[other as usize] = next;
                    self.inward[other as usize] = node;
                    heap.push(Reverse((next.to_bits(), other)));
                }
            }
        }
        budget.spend(work);
    }

    /// A shortest closed walk from `start` with an odd number of repulsive edges, if it is short enough.
    fn odd_walk(&mut self, start: u32, paid: &[f64], budget: &mut Budget) -> Option<Vec<u32>> {
        let (source, goal) = (2 * start, 2 * start + 1);
        let mut heap = BinaryHeap::from([Reverse((0u64, source))]);
        self.length[source as usize] = 0.0;
        self.touched.push(source);
        let mut work = 0;
        let mut reached = false;
        while let Some(Reverse((bits, state))) = heap.pop() {
            let length = f64::from_bits(bits);
            if length > self.length[state as usize] {
                continue;
            }
            if state == goal {
                reached = true;
                break;
            }
            let (node, parity) = (state / 2, state % 2);
            let radius = self.radius[node as usize];
            work += self.kernel.arcs(node).len() as u64;
            for &(other, edge) in self.kernel.arcs(node) {
                let outside = self.radius[other as usize];
                if outside.is_infinite() || self.done[other as usize] {
                    continue;
                }
                let pay = paid[edge as usize];
                let (step, parity) = if self.kernel.costs[edge as usize] > 0.0 {
                    (pay + (outside - radius) / 2.0, parity)
                } else {
                    (pay + (outside + radius - 1.0) / 2.0, 1 - parity)
                };
                let next = length + step.max(0.0) + TOLL;
                let state_of_other = 2 * other + parity;
                let known = self.length[state_of_other as usize];
                if next < known.min(0.5 - LEAST) {
                    if known.is_infinite() {
                        self.touched.push(state_of_other);
                    }
                    self.length[state_of_other as usize] = next;
                    self.previous[state_of_other as usize] = state;
                    heap.push(Reverse((next.to_bits(), state_of_other)));
                }
            }
        }
        budget.spend(work);
        for state in self.touched.drain(..) {
            self.length[state as usize] = f64::INFINITY;
        }
        reached.then(|| {
            let mut walk = Vec::new();
            let mut state = goal;
            while state != source {
                state = self.previous[state as usize];
                walk.push(state / 2);
            }
            walk.reverse();
            walk
        })
    }

    fn wheel(&self, centre: u32, rim: Vec<u32>) -> Wheel {
        let next = rim.iter().skip(1).chain(rim.first());
        let repels = |tail: u32, head: u32| {
            self.kernel.edge(tail, head).is_some_and(|edge| self.kernel.costs[edge as usize] < 0.0)
        };
        let spokes = rim
            .iter()
            .zip(next)
            .filter(|&(&tail, &head)| repels(tail, head))
            .map(|(&tail, _)| {
                let mut spoke = vec![tail];
                let mut node = tail;
                while node != centre {
                    node = self.inward[node as usize];
                    spoke.push(node);
                }
                spoke.reverse();
                spoke
            })
            .collect();
        Wheel { rim, spokes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bound::packing::Packing;
    use crate::bound::relaxation::solve_relaxation;
    use crate::graph::signed_graph::SignedGraph;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    /// A centre 0 that attracts the nodes of a ring, which repel each other.
    fn wheel_graph(ring: u32, spoke: f64, rim: f64) -> SignedGraph {
        let edges = (0..ring).flat_map(|i| [(0, i + 1, spoke), (i + 1, (i + 1) % ring + 1, -rim)]);
        SignedGraph::new(ring as usize + 1, edges)
    }

    /// What every multicut pays for each edge.
    fn pays(kernel: &Kernel) -> Vec<Vec<f64>> {
        let nodes = kernel.node_count() as u32;
        let labellings = nodes.pow(nodes);
        (0..labellings)
            .map(|code| {
                let label = |node: u32| code / nodes.pow(node) % nodes;
                let cut = kernel.ends.iter().map(|&(tail, head)| label(tail) != label(head));
                cut.zip(&kernel.costs).map(|(cut, &cost)| f64::from(u8::from(cut == (cost > 0.0)))).collect()
            })
            .collect()
    }

    fn value(uses: &[(u32, u32)], paid: &[f64]) -> f64 {
        uses.iter().map(|&(edge, times)| f64::from(times) * paid[edge as usize]).sum()
    }

    #[test]
    fn every_multicut_of_small_graphs_pays_for_every_wheel() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let (mut wheels, mut tight) = (0, 0);
        for _ in 0..60 {
            let pairs = (0..5u32).flat_map(|u| (0..u).map(move |v| (u, v)));
            let edges: Vec<_> =
                pairs.map(|(u, v)| (u, v, [-1.0, 1.0, 0.0][random.random_range(0..3)])).collect();
            let kernel = Kernel::new(&SignedGraph::new(5, edges.iter().copied()));
            let pays = pays(&kernel);
            // Any metric makes wheels, violated or not, so random weights test the walks.
            for _ in 0..20 {
                let paid: Vec<f64> =
                    (0..kernel.edge_count()).map(|_| random.random_range(0.0..0.45)).collect();
                let mut separation = WheelSeparation::new(&kernel);
                for wheel in separation.violated(&paid, &mut Budget::new(None, None)) {
                    let uses = wheel.uses(&kernel);
                    let least = pays.iter().map(|paid| value(&uses, paid)).fold(f64::INFINITY, f64::min);
                    assert!(least >= wheel.least(), "{wheel:?} {least}");
                    wheels += 1;
                    tight += usize::from(least == wheel.least());
                }
            }
        }
        assert!(wheels > 100 && tight > 50, "{wheels} {tight}");
    }

    #[test]
    fn a_wheel_is_found_where_spokes_are_half_cut() {
        for ring in [3, 5, 7] {
            let kernel = Kernel::new(&wheel_graph(ring, 1.0, 1.0));
            let paid: Vec<f64> =
                kernel.costs.iter().map(|&cost| if cost > 0.0 { 0.5 } else { 0.0 }).collect();
            let found = WheelSeparation::new(&kernel).violated(&paid, &mut Budget::new(None, None));
            let [Conflict::Wheel(wheel)] = &found[..] else { panic!("{found:?}") };
            assert_eq!((wheel.rim.len(), wheel.spokes.len()), (ring as usize, ring as usize));
            assert_eq!(found[0].least(), f64::from(ring.div_ceil(2)));
        }
        // For an even ring, cycle inequalities are enough.
        let kernel = Kernel::new(&wheel_graph(4, 1.0, 1.0));
        let paid: Vec<f64> = kernel.costs.iter().map(|&cost| if cost > 0.0 { 0.5 } else { 0.0 }).collect();
        assert!(WheelSeparation::new(&kernel).violated(&paid, &mut Budget::new(None, None)).is_empty());
    }

    #[test]
    fn wheels_close_what_cycles_leave_open() {
        for ring in [3, 5, 7] {
            let graph = wheel_graph(ring, 0.5, 0.75);
            let kernel = Kernel::new(&graph);
            let budget = &mut Budget::new(None, None);
            let optimum = pays_least(&kernel);
            let mut packing = Packing::new(&kernel);
            packing.extend(&kernel, u64::MAX, budget);
            let relaxation = solve_relaxation(&kernel, packing, Vec::new(), optimum, |_| false, budget);
            assert!(
                (relaxation.packing.bound - optimum).abs() < 1e-6,
                "{ring} {optimum} {:?}",
                relaxation.packing
            );
            // Cycles alone give half a spoke for each node of the ring.
            let cycles = kernel.negative_sum() + 0.25 * f64::from(ring);
            assert!(relaxation.packing.bound > cycles + 0.1);
        }
    }

    fn pays_least(kernel: &Kernel) -> f64 {
        let nodes = kernel.node_count() as u32;
        // Each ring node is in the centre's cluster or alone, so all partitions follow from the set of nodes that are alone.
        (0..1u32 << (nodes - 1))
            .map(|alone| {
                let apart = |node: u32| node > 0 && (alone >> (node - 1)) & 1 == 1;
                let cut = |&(tail, head): &(u32, u32)| apart(tail) || apart(head);
                kernel
                    .ends
                    .iter()
                    .zip(&kernel.costs)
                    .filter(|entry| cut(entry.0))
                    .map(|entry| entry.1)
                    .sum::<f64>()
            })
            .fold(0.0, f64::min)
    }
}

//! Cheapest tight cycles under prices of contested edges.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// Price of an edge that is used up, in edges with capacity left.
const CONTESTED: u32 = 30;

/// Rise of that price each time that the edge is contested.
const RISE: u32 = 15;

/// The memory of a negotiation, and the scratch of its searches.
pub(crate) struct Negotiation {
    /// How often each edge was contested.
    contests: Vec<u32>,
    distance: Vec<u32>,
    parent: Vec<u32>,
    /// Which end of the paid edge a node was reached from.
    side: Vec<bool>,
    settled: Vec<bool>,
    touched: Vec<u32>,
}

impl Negotiation {
    pub(crate) fn new(kernel: &Kernel) -> Self {
        let nodes = kernel.node_count();
        Self {
            contests: vec![0; kernel.edge_count()],
            distance: vec![u32::MAX; nodes],
            parent: vec![0; nodes],
            side: vec![false; nodes],
            settled: vec![false; nodes],
            touched: Vec::new(),
        }
    }

    /// Makes an edge dearer.
    pub(crate) fn contest(&mut self, edge: u32) {
        self.contests[edge as usize] = self.contests[edge as usize].saturating_add(1);
    }

    fn price(&self, edge: u32, open: bool) -> u32 {
        let contests = self.contests[edge as usize].min(1 << 16);
        if open { 1 + contests } else { 1 + CONTESTED + RISE * contests }
    }

    /// The nodes of the cheapest tight cycle through an edge that the labels pay for; its last edge, from the last node to the
    /// first, is the repulsive one. Searches from both ends of the edge, inside their clusters.
    pub(crate) fn cheapest(
        &mut self,
        kernel: &Kernel,
        labels: &[u32],
        edge: u32,
        open: impl Fn(u32) -> bool,
        budget: &mut Budget,
    ) -> Option<Vec<u32>> {
        let ends = kernel.ends[edge as usize];
        let repulsive = kernel.costs[edge as usize] < 0.0;
        let mut heap = BinaryHeap::new();
        for (node, side) in [(ends.0, false), (ends.1, true)] {
            self.reach(node, node, 0, side);
            heap.push(entry(0, node));
        }
        let mut best: Option<(u32, u32, u32)> = None;
        let mut work = 0;
        while let Some(Reverse(first)) = heap.pop() {
            let (distance, node) = ((first >> 32) as u32, first as u32);
            if best.is_some_and(|best| distance >= best.0) {
                break;
            }
            if std::mem::replace(&mut self.settled[node as usize], true) {
                continue;
            }
            let side = self.side[node as usize];
            work += kernel.arcs(node).len() as u64;
            for &(other, arc) in kernel.arcs(node) {
                if arc == edge {
                    continue;
                }
                let attractive = kernel.costs[arc as usize] > 0.0;
                let inside = labels[node as usize] == labels[other as usize];
                let place = other as usize;
                let next = distance + self.price(arc, open(arc));
                // The cycle closes where both searches meet: inside the cluster, or over a cut repulsive edge.
                let closes = if repulsive { attractive && inside } else { !attractive && !inside };
                if closes && self.settled[place] && self.side[place] != side {
                    let total = next + self.distance[place];
                    if best.is_none_or(|best| total < best.0) {
                        best = Some((total, node, other));
                    }
                } else if attractive && inside && !self.settled[place] && next < self.distance[place] {
                    self.reach(other, node, next, side);
                    heap.push(entry(next, other));
                }
            }
        }
        budget.spend(work);
        let cycle = best.map(|(_, first, second)| {
            let (mut one, mut two) = (self.path(first), self.path(second));
            if repulsive {
                one.reverse();
            } else {
                two.reverse();
            }
            one.extend(two);
            one
        });
        for node in self.touched.drain(..) {
            self.distance[node as usize] = u32::MAX;
            self.settled[node as usize] = false;
        }
        cycle
    }

    fn reach(&mut self, node: u32, parent: u32, distance: u32, side: bool) {
        let place = node as usize;
        if self.distance[place] == u32::MAX {
            self.touched.push(node);
        }
        self.distance[place] = distance;
        self.parent[place] = parent;
        self.side[place] = side;
    }

    /// The nodes from a reached one back to the end it was reached from.
    fn path(&self, mut node: u32) -> Vec<u32> {
        let mut path = vec![node];
        while self.parent[node as usize] != node {
            node = self.parent[node as usize];
            path.push(node);
        }
        path
    }
}

/// A node in the queue by distance, then number, in one word, because pairs take longer to compare.
fn entry(distance: u32, node: u32) -> Reverse<u64> {
    Reverse(u64::from(distance) << 32 | u64::from(node))
}

//! Finds violated cycle inequalities.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::conflict::Conflict;
use super::landmark_distances::LandmarkDistances;
use crate::budget::Budget;
use crate::graph::kernel::Kernel;

/// Separation by shortest paths.
pub(crate) struct CycleSeparation<'a> {
    kernel: &'a Kernel,
    distance: Vec<f64>,
    parent: Vec<u32>,
    touched: Vec<u32>,
    landmarks: LandmarkDistances,
}

/// Toll for each hop, so that short paths win among equally cheap ones.
const TOLL: f64 = 1e-9;

/// Longer cycles are added only while their edges have room for them: otherwise there would be many, and nearly the same.
const SHORT: usize = 24;

/// Most long cycles over one edge that are added in one round.
const CROWD: u8 = 12;

/// A round ends when the crowded cycles outnumber those found by this many.
const PATIENCE: usize = 30;

/// Bound on the rounding errors of landmark distances.
const ROUNDING: f32 = 1e-5;

impl<'a> CycleSeparation<'a> {
    pub(crate) fn new(kernel: &'a Kernel) -> Self {
        let nodes = kernel.node_count();
        let (distance, parent) = (vec![f64::INFINITY; nodes], vec![0; nodes]);
        Self { kernel, distance, parent, touched: Vec::new(), landmarks: LandmarkDistances::hops(kernel) }
    }

    /// For each repulsive edge, the most violated cycle, if it is violated by more than `least`. Runs one Dijkstra search for
    /// each node over attractive edges, cut off at distance 1.
    pub(crate) fn violated(&mut self, paid: &[f64], least: f64, budget: &mut Budget) -> Vec<Conflict> {
        let mut found = Vec::new();
        let mut load = vec![0u8; self.kernel.edge_count()];
        let mut rejected = 0;
        self.landmarks.update(self.kernel, |edge| paid[edge as usize].max(0.0) + TOLL);
        for source in 0..self.kernel.node_count() as u32 {
            let goals: Vec<(u32, f64)> = self
                .kernel
                .arcs(source)
                .iter()
                .filter(|&&(node, edge)| node > source && self.kernel.costs[edge as usize] < 0.0)
                .map(|&(node, edge)| (node, 1.0 - least - paid[edge as usize]))
                .filter(|&(goal, reach)| reach > f64::from(self.landmarks.at_least(source, goal) - ROUNDING))
                .collect();
            if goals.is_empty() {
                continue;
            }
            self.search(source, &goals, paid, budget);
            for (goal, reach) in goals {
                if self.distance[goal as usize] < reach {
                    let mut path = vec![goal];
                    let mut node = goal;
                    while node != source {
                        node = self.parent[node as usize];
                        path.push(node);
                    }
                    if path.len() <= SHORT || self.fits(&path, &mut load) {
                        found.push(Conflict::Cycle(path));
                    } else {
                        rejected += 1;
                    }
                }
            }
            for node in self.touched.drain(..) {
                self.distance[node as usize] = f64::INFINITY;
            }
            if budget.is_over() || rejected > found.len() + PATIENCE {
                break;
            }
        }
        found
    }

    /// Whether no edge of a path is crowded yet; if so, counts it.
    fn fits(&self, path: &[u32], load: &mut [u8]) -> bool {
        let edges = || path.windows(2).filter_map(|pair| self.kernel.edge(pair[0], pair[1]));
        let fits = edges().all(|edge| load[edge as usize] < CROWD);
        if fits {
            edges().for_each(|edge| load[edge as usize] += 1);
        }
        fits
    }

    fn search(&mut self, source: u32, goals: &[(u32, f64)], paid: &[f64], budget: &mut Budget) {
        let reach = goals.iter().map(|goal| goal.1).fold(0.0, f64::max);
        let mut heap = BinaryHeap::from([Reverse((0u64, source))]);
        self.distance[source as usize] = 0.0;
        self.touched.push(source);
        let mut work = 0;
        while let Some(Reverse((bits, node))) = heap.pop() {
            let distance = f64::from_bits(bits);
            if distance > self.distance[node as usize] {
                continue;
            }
            work += self.kernel.arcs(node).len() as u64;
            for &(other, edge) in self.kernel.arcs(node) {
                if self.kernel.costs[edge as usize] <= 0.0 {
                    continue;
                }
                let next = distance + paid[edge as usize].max(0.0) + TOLL;
                let leads = || {
                    let near = |&(goal, reach): &(u32, f64)| {
                        next + f64::from(self.landmarks.at_least(other, goal) - ROUNDING) < reach
                    };
                    goals.len() > 4 || goals.iter().any(near)
                };
                if next < reach && next < self.distance[other as usize] && leads() {
                    if self.distance[other as usize] == f64::INFINITY {
                        self.touched.push(other);
                    }
                    self.distance[other as usize] = next;
                    self.parent[other as usize] = node;
                    heap.push(Reverse((next.to_bits(), other)));
                }
            }
        }
        budget.spend(work);
    }
}

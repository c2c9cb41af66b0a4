//! The cycle relaxation: a linear program whose inequalities are found as they are violated.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

use crate::budget::Budget;
use crate::interior_point::{Row, minimise_covering};
use crate::kernel::Kernel;
use crate::landmark_distances::LandmarkDistances;
use crate::packing::Packing;

/// The best packing found, and a point of the relaxation.
#[derive(Debug, Clone)]
pub(crate) struct Relaxation {
    pub(crate) packing: Packing,
    /// How much each edge's cost is paid: `y` for an attractive edge, `1 - y` for a repulsive one.
    pub(crate) paid: Vec<f64>,
    /// Whether no cycle inequality is violated any more.
    pub(crate) converged: bool,
}

/// The conflicted cycles of the program.
struct Cycles {
    nodes: Vec<Vec<u32>>,
    edges: Vec<Vec<u32>>,
    known: HashSet<Vec<u32>>,
}

impl Cycles {
    fn of(kernel: &Kernel, packing: &Packing) -> Self {
        let mut cycles = Self { nodes: Vec::new(), edges: Vec::new(), known: HashSet::new() };
        for cycle in &packing.cycles {
            cycles.add(kernel, cycle.nodes.clone());
        }
        cycles
    }

    fn add(&mut self, kernel: &Kernel, nodes: Vec<u32>) -> bool {
        let edges = kernel.cycle_edges(&nodes);
        let mut sorted = edges.clone();
        sorted.sort_unstable();
        let new = self.known.insert(sorted);
        if new {
            self.nodes.push(nodes);
            self.edges.push(edges);
        }
        new
    }

    /// Keeps the cycles for which `keep` holds at their position.
    fn retain(&mut self, keep: impl Fn(usize) -> bool) {
        let mut index = 0;
        self.nodes.retain(|_| {
            index += 1;
            keep(index - 1)
        });
        index = 0;
        let known = &mut self.known;
        self.edges.retain(|edges| {
            index += 1;
            let kept = keep(index - 1);
            if !kept {
                let mut sorted = edges.clone();
                sorted.sort_unstable();
                known.remove(&sorted);
            }
            kept
        });
    }
}

/// Solves `min c^+ y + |c^-| (1 - y)` over the cycle inequalities (Chopra, Rao 1993): for each repulsive edge `f` and each
/// attractive path `P` between its ends, `y(P) + (1 - y_f) >= 1`. Cycles with other numbers of repulsive edges do not change
/// the optimum (Lange, Karrenbauer, Andres, ICML 2018), so this is a covering program, and its dual packs cycles:
/// every dual point is a certificate.
///
/// Starts from the cycles of `start`, and ends when no inequality is violated, when the bound reaches `target`, or with
/// the budget, or when the bound has all but ceased to rise and `give_up` finds the packing good enough. Early rounds stop far from the optimum, where
/// cuts are deep.
pub(crate) fn solve_relaxation(
    kernel: &Kernel,
    start: Packing,
    target: f64,
    give_up: impl Fn(&Packing) -> bool,
    budget: &mut Budget,
) -> Relaxation {
    let mut cycles = Cycles::of(kernel, &start);
    let mut restarted_at = start.bound;
    let magnitude: f64 = kernel.costs.iter().map(|cost| cost.abs()).sum();
    let mut relaxation =
        Relaxation { packing: start, paid: vec![0.0; kernel.edge_count()], converged: false };
    let mut separation = Separation::new(kernel);
    let mut accuracy = 1e-2;
    let mut missing = Vec::new();
    let mut last_bound = f64::NEG_INFINITY;
    while !budget.is_over() && !cycles.nodes.is_empty() {
        // Only edges on some cycle are variables; the others are paid nothing.
        let mut column = vec![u32::MAX; kernel.edge_count()];
        let mut costs = Vec::new();
        let rows: Vec<Row> = cycles
            .edges
            .iter()
            .map(|edges| {
                let entries = edges.iter().map(|&edge| {
                    let place = &mut column[edge as usize];
                    if *place == u32::MAX {
                        *place = costs.len() as u32;
                        costs.push(kernel.costs[edge as usize].abs());
                    }
                    (*place, 1.0)
                });
                Row { entries: entries.collect(), least: 1.0 }
            })
            .collect();
        // The gap that matters is relative to what is paid, not to the sum of all costs.
        let scale = (relaxation.packing.bound - kernel.negative_sum()).max(magnitude * 1e-6);
        let Some(point) = minimise_covering(&costs, &rows, accuracy * scale, budget) else { break };
        for (edge, &place) in column.iter().enumerate() {
            relaxation.paid[edge] = if place == u32::MAX { 0.0 } else { point.values[place as usize] };
        }
        let weighted = cycles.nodes.iter().zip(&cycles.edges).zip(&point.weights);
        let weighted = weighted.map(|((nodes, edges), &weight)| (nodes.clone(), edges.clone(), weight));
        let mut packing = Packing::from_weights(kernel, weighted.filter(|entry| entry.2 > 1e-11 * scale));
        packing.extend(kernel, u64::MAX, budget);
        if packing.bound > relaxation.packing.bound {
            relaxation.packing = packing;
        }
        if kernel.rounded(relaxation.packing.bound) >= target {
            break;
        }
        missing.push(target - relaxation.packing.bound);
        if let [.., before, _, _, now] = missing[..]
            && now > 0.95 * before
        {
            if give_up(&relaxation.packing) {
                break;
            }
            // Where packing what the weights left brought more than the weights themselves, its cycles make the
            // better program.
            if relaxation.packing.bound > restarted_at {
                restarted_at = relaxation.packing.bound;
                missing.clear();
                cycles = Cycles::of(kernel, &relaxation.packing);
                continue;
            }
        }
        let least = (accuracy * 0.1).max(1e-7);
        let violated = separation.violated(&relaxation.paid, least, budget);
        if point.gap <= accuracy * scale
            && point_bound(kernel, &point.weights) > last_bound + 1e-9 * magnitude
        {
            // The bound rises, so dropped cycles cannot come back for ever.
            last_bound = point_bound(kernel, &point.weights);
            let keep: Vec<bool> = rows
                .iter()
                .zip(&point.weights)
                .map(|(row, &weight)| {
                    row.value(&point.values) < 1.5
                        || weight > accuracy * 0.01 * costs[row.entries[0].0 as usize]
                })
                .collect();
            cycles.retain(|index| keep[index]);
        }
        let mut added = false;
        for nodes in violated {
            added |= cycles.add(kernel, nodes);
        }
        if !added {
            if accuracy <= 1e-9 || point.gap > accuracy * scale {
                relaxation.converged = point.gap <= accuracy * scale;
                break;
            }
            accuracy *= 1e-2;
            if accuracy < 1e-9 {
                accuracy = 1e-9;
            }
        }
    }
    relaxation
}

fn point_bound(kernel: &Kernel, weights: &[f64]) -> f64 {
    kernel.negative_sum() + weights.iter().sum::<f64>()
}

/// Finds violated cycle inequalities by shortest paths.
struct Separation<'a> {
    kernel: &'a Kernel,
    distance: Vec<f64>,
    parent: Vec<u32>,
    touched: Vec<u32>,
    landmarks: LandmarkDistances,
}

/// Toll a hop: of paths as cheap, short ones are preferred.
const TOLL: f64 = 1e-9;

/// Longer cycles are added only as far as edges are not crowded with them: they would be many, and all alike.
const SHORT: usize = 24;

/// Long cycles over one edge that are added in one round.
const CROWD: u8 = 12;

/// Crowded cycles, beyond as many as were found, that end a round.
const PATIENCE: usize = 30;

/// Rounding of landmark distances.
const ROUNDING: f32 = 1e-5;

impl<'a> Separation<'a> {
    fn new(kernel: &'a Kernel) -> Self {
        let nodes = kernel.node_count();
        let (distance, parent) = (vec![f64::INFINITY; nodes], vec![0; nodes]);
        Self { kernel, distance, parent, touched: Vec::new(), landmarks: LandmarkDistances::hops(kernel) }
    }

    /// For each repulsive edge the most violated cycle, if it is violated by more than `least`: one Dijkstra search
    /// a node over attractive edges, cut off at distance 1.
    fn violated(&mut self, paid: &[f64], least: f64, budget: &mut Budget) -> Vec<Vec<u32>> {
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
                        found.push(path);
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

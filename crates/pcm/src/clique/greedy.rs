//! Greedy cliques to start from.

use super::buckets::Buckets;
use super::degeneracy::Degeneracy;
use super::{BitGraph, BitSet};

/// Starts of [`along_degeneracy`]. More would find nothing that local search does not find sooner.
const STARTS: usize = 4;

/// The largest of several greedy cliques. Each starts at another vertex and takes its neighbours along the reversed
/// degeneracy order, the densest part first. O(starts * clique * N / 64).
pub(super) fn along_degeneracy(graph: &BitGraph, degeneracy: &Degeneracy) -> Vec<usize> {
    let mut best = Vec::new();
    let mut candidates = BitSet::new(graph.len());
    let stride = (degeneracy.order.len() / STARTS).max(1);
    for &start in degeneracy.order.iter().rev().step_by(stride) {
        if degeneracy.core[start] < best.len() {
            continue;
        }
        candidates.clear();
        for &vertex in &degeneracy.order {
            if degeneracy.core[vertex] >= best.len() {
                candidates.insert(vertex);
            }
        }
        candidates.intersect(graph.neighbours(start));
        let mut clique = vec![start];
        for &vertex in degeneracy.order.iter().rev() {
            if candidates.contains(vertex) {
                clique.push(vertex);
                candidates.intersect(graph.neighbours(vertex));
            }
        }
        if clique.len() > best.len() {
            best = clique;
        }
    }
    best
}

/// The clique that always takes the candidate with the fewest non-neighbours among the candidates: the minimum-degree
/// greedy for independent sets, on the complement. O(N^2 / 64 + edges of the complement).
pub(super) fn fewest_conflicts(graph: &BitGraph, alive: &BitSet) -> Vec<usize> {
    let mut candidates = alive.clone();
    let members: Vec<usize> = alive.members().collect();
    let mut queue = Buckets::new(graph.len(), members.len());
    for &vertex in members.iter().rev() {
        queue.insert(vertex, members.len() - 1 - alive.count_within(graph.neighbours(vertex)));
    }
    let mut clique = Vec::new();
    let mut key = 0;
    let (mut removed, mut touched) = (Vec::new(), Vec::new());
    let mut left = members.len();
    while left > 0 {
        let Some(vertex) = queue.first(key) else {
            key += 1;
            continue;
        };
        clique.push(vertex);
        removed.clear();
        removed.extend(candidates.members_outside(graph.neighbours(vertex)));
        for &gone in &removed {
            queue.remove(gone);
            candidates.remove(gone);
        }
        left -= removed.len();
        for &gone in removed.iter().filter(|&&gone| gone != vertex) {
            touched.clear();
            touched.extend(candidates.members_outside(graph.neighbours(gone)));
            for &other in &touched {
                queue.decrease(other);
                key = key.min(queue.key(other));
            }
        }
    }
    clique
}

//! Vertices that no larger clique needs.

use super::degeneracy::Degeneracy;
use super::{BitGraph, BitSet};

/// Keeps the vertices that may lie in a clique of more than `incumbent` vertices by their core number.
pub(super) fn keep_core(degeneracy: &Degeneracy, alive: &mut BitSet, incumbent: usize) {
    for &vertex in &degeneracy.order {
        if degeneracy.core[vertex] < incumbent {
            alive.remove(vertex);
        }
    }
}

/// Drops dominated vertices: u and v are no neighbours, and every neighbour of u is one of v. A clique through u stays a
/// clique with v in its place, so a largest one survives. Repeated until nothing changes.
///
/// In the complement this is the dominance rule of vertex cover; it takes pendant vertices, vertices whose neighbours
/// all agree, and twins. O(edges of the complement) tests a round, most of which end at their first words.
pub(super) fn drop_dominated(graph: &BitGraph, alive: &mut BitSet) {
    let mut conflicts = vec![0_usize; graph.len()];
    let mut remaining = alive.count();
    for vertex in alive.members() {
        conflicts[vertex] = remaining - 1 - alive.count_within(graph.neighbours(vertex));
    }
    let mut pending = alive.clone();
    let mut rivals = Vec::new();
    while !pending.is_empty() {
        let round: Vec<usize> = pending.members().collect();
        pending.clear();
        for vertex in round {
            if !alive.contains(vertex) || conflicts[vertex] == 0 {
                continue;
            }
            let row = graph.neighbours(vertex);
            rivals.clear();
            rivals.extend(alive.members_outside(row).filter(|&rival| rival != vertex));
            let dominated = rivals.iter().any(|&rival| {
                conflicts[rival] <= conflicts[vertex] && alive.is_within(row, graph.neighbours(rival))
            });
            if !dominated {
                continue;
            }
            alive.remove(vertex);
            remaining -= 1;
            for &rival in &rivals {
                conflicts[rival] -= 1;
                // With one conflict less, the rival may dominate what it conflicts with.
                alive.members_outside(graph.neighbours(rival)).for_each(|other| pending.insert(other));
            }
        }
    }
    debug_assert_eq!(remaining, alive.count(), "every vertex that went was counted");
}

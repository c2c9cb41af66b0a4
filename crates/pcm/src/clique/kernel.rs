//! Removes vertices that no larger clique needs.

use super::colouring::{Colouring, Rows};
use super::degeneracy::Degeneracy;
use super::propagation::Contradictions;
use super::{BitGraph, BitSet};

/// Removes vertices by core numbers, by colours and by dominance until none of these finds more.
pub(super) fn shrink(graph: &BitGraph, alive: &mut BitSet, incumbent: usize) {
    loop {
        let before = alive.count();
        let degeneracy = Degeneracy::of(graph, alive);
        keep_core(&degeneracy, alive, incumbent);
        drop_by_colours(graph, alive, degeneracy.order.iter().rev().copied(), incumbent);
        if alive.count() * 10 < before * 9 {
            // Dominance is the slowest test, and faster on fewer vertices.
            continue;
        }
        drop_dominated(graph, alive);
        if alive.count() == before {
            return;
        }
    }
}

/// Keeps the vertices whose core number allows a clique of more than `incumbent` vertices.
pub(super) fn keep_core(degeneracy: &Degeneracy, alive: &mut BitSet, incumbent: usize) {
    for &vertex in &degeneracy.order {
        if degeneracy.core[vertex] < incumbent {
            alive.remove(vertex);
        }
    }
}

/// Removes vertices that cannot lie in a clique of more than `incumbent` vertices, by colours: a clique through a vertex
/// uses no class that conflicts as a whole with this vertex (Rossi, Gleich, Gebremedhin, Patwary 2014, who count the
/// colours of its neighbours).
///
/// `order` is the order of colouring. It contains all vertices alive, and possibly others.
///
/// A vertex that conflicts with a whole region, as a false edge often does, loses all colours of that region. Once the
/// incumbent is close to the number of colours, few such vertices remain. A pass takes O(N^2 / 64 + edges of the
/// complement); passes repeat while each removes a tenth.
pub(super) fn drop_by_colours(
    graph: &BitGraph,
    alive: &mut BitSet,
    order: impl Iterator<Item = usize>,
    incumbent: usize,
) {
    let mut colouring = Colouring::new(graph.len());
    colouring.colour(order.filter(|&vertex| alive.contains(vertex)), &Rows { graph, alive });
    drop_by_classes(graph, alive, colouring, Contradictions::default(), incumbent);
}

/// As [`drop_by_colours`], with a given colouring of the vertices `alive` and contradictions between its classes. If a
/// vertex removes no class of such a contradiction, one more class goes unused.
pub(super) fn drop_by_classes(
    graph: &BitGraph,
    alive: &mut BitSet,
    mut colouring: Colouring,
    mut contradictions: Contradictions,
    incumbent: usize,
) {
    let mut colours = colouring.classes.len();
    loop {
        let members: Vec<usize> = alive.members().collect();
        let mut dropped = 0;
        for &vertex in &members {
            let own = colouring.class_of[vertex];
            let conflicts = Rows { graph, alive };
            // The class of the vertex is not lost: the vertex itself uses it.
            let lost = colouring.classes_in_conflict(vertex, &conflicts).filter(|&class| class != own);
            let lost: Vec<u32> = lost.collect();
            let touched = contradictions.touched(lost.iter().copied());
            if colours + touched > incumbent + lost.len() + contradictions.count {
                continue;
            }
            alive.remove(vertex);
            if colouring.forget(vertex) {
                colours -= 1;
                contradictions.retire(own);
            }
            dropped += 1;
        }
        if dropped * 10 < members.len().max(1) {
            return;
        }
    }
}

/// Removes dominated vertices: u, if u and v are not neighbours and every neighbour of u is also one of v. A clique through
/// u remains a clique with v in its place, so a largest one survives. Repeats until nothing changes.
///
/// In the complement this is the dominance rule of vertex cover. It removes pendant vertices, vertices whose neighbours all
/// agree, and twins. O(edges of the complement) tests a round, most of which end at their first words.
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
                conflicts[rival] <= conflicts[vertex]
                    && alive.is_within(row, graph.neighbours(rival), rival / 64)
            });
            if !dominated {
                continue;
            }
            alive.remove(vertex);
            remaining -= 1;
            for &rival in &rivals {
                conflicts[rival] -= 1;
                // With one conflict less, the rival may dominate the vertices that it conflicts with.
                alive.members_outside(graph.neighbours(rival)).for_each(|other| pending.insert(other));
            }
        }
    }
    debug_assert_eq!(remaining, alive.count(), "every vertex that went was counted");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clique::colouring::Lists;
    use crate::clique::tests::{drawn, enumerate, rings};
    use proptest::prelude::*;

    fn left_by_colours(graph: &BitGraph, incumbent: usize) -> Vec<usize> {
        let mut alive = BitSet::full(graph.len());
        let degeneracy = Degeneracy::of(graph, &alive);
        drop_by_colours(graph, &mut alive, degeneracy.order.iter().rev().copied(), incumbent);
        alive.members().collect()
    }

    #[test]
    fn a_vertex_that_costs_more_colours_than_it_brings_goes() {
        // 0 conflicts with three of the clique 1, 2, 3, 4.
        let mut graph = BitGraph::new(5);
        for (one, other) in [(1, 2), (1, 3), (2, 3), (0, 4), (1, 4), (2, 4), (3, 4)] {
            graph.connect(one, other);
        }
        assert_eq!(left_by_colours(&graph, 1), [0, 1, 2, 3, 4]);
        assert_eq!(left_by_colours(&graph, 2), [1, 2, 3, 4]);
        assert_eq!(left_by_colours(&graph, 4), [0_usize; 0]);
    }

    /// Uses a colouring of `coarser`, a graph with more edges, which needs more colours.
    fn left_by_classes_of(graph: &BitGraph, coarser: &BitGraph, incumbent: usize) -> Vec<usize> {
        let mut alive = BitSet::full(graph.len());
        let mut colouring = Colouring::new(graph.len());
        colouring.colour(0..graph.len(), &Lists::of_graph(coarser));
        let contradictions = Contradictions::of(&colouring, &Lists::of_graph(graph));
        drop_by_classes(graph, &mut alive, colouring, contradictions, incumbent);
        alive.members().collect()
    }

    fn left_by_classes(graph: &BitGraph, incumbent: usize) -> Vec<usize> {
        left_by_classes_of(graph, graph, incumbent)
    }

    fn left_by_classes_of_one(graph: &BitGraph, incumbent: usize) -> Vec<usize> {
        let complete = drawn(graph.len(), 1.0, &[0.0; 78]);
        left_by_classes_of(graph, &complete, incumbent)
    }

    #[test]
    fn contradictions_leave_nothing_of_rings_of_odd_length() {
        assert_eq!(left_by_classes(&rings(), 9).len(), 25);
        assert_eq!(left_by_classes(&rings(), 10).len(), 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn colours_drop_nothing_that_a_larger_clique_needs(
            vertices in 1_usize..=13,
            density in 0.0_f64..1.0,
            draws in proptest::collection::vec(0.0_f64..1.0, 78),
            less in 1_usize..4,
        ) {
            let graph = drawn(vertices, density, &draws);
            let largest = enumerate(&graph);
            for left in [left_by_colours, left_by_classes, left_by_classes_of_one] {
                let left = graph.induced(&left(&graph, largest.saturating_sub(less)));
                prop_assert_eq!(enumerate(&left), largest);
            }
        }
    }
}

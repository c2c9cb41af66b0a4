//! Connected components of the complement.

use super::{BitGraph, BitSet};

/// The components of the complement of the graph of the vertices `alive`. Each is ascending, and they are ordered by their
/// smallest vertex. A clique of the graph consists of a clique in each of them. O(N^2 / 64) words.
pub(super) fn complement_components(graph: &BitGraph, alive: &BitSet) -> Vec<Vec<usize>> {
    let mut unseen = alive.clone();
    let mut components = Vec::new();
    let mut reached = BitSet::new(graph.len());
    for start in alive.members() {
        if !unseen.contains(start) {
            continue;
        }
        unseen.remove(start);
        let mut component = vec![start];
        let mut next = 0;
        while let Some(&vertex) = component.get(next) {
            next += 1;
            reached.assign_difference(&unseen, graph.neighbours(vertex));
            component.extend(reached.members());
            unseen.subtract(reached.words());
        }
        component.sort_unstable();
        components.push(component);
    }
    components
}

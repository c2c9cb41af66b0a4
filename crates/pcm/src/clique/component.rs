//! Connected components of the complement.

use super::{BitGraph, BitSet};

/// The components of the complement graph, each ascending, by their smallest vertex. O(N^2 / 64) words.
pub(super) fn complement_components(graph: &BitGraph) -> Vec<Vec<usize>> {
    let mut unseen = BitSet::new(graph.len());
    (0..graph.len()).for_each(|vertex| unseen.insert(vertex));
    let mut components = Vec::new();
    let mut reached = BitSet::new(graph.len());
    while let Some(start) = unseen.first() {
        unseen.remove(start);
        let mut component = vec![start];
        let mut next = 0;
        while let Some(&vertex) = component.get(next) {
            next += 1;
            reached.copy_from(&unseen);
            reached.subtract(graph.neighbours(vertex));
            component.extend(reached.members());
            unseen.subtract(&reached);
        }
        component.sort_unstable();
        components.push(component);
    }
    components
}

//! Core numbers: bounds on the cliques through a vertex, by degrees alone.

use super::buckets::Buckets;
use super::{BitGraph, BitSet};

/// The degeneracy order of a graph and its core numbers (Matula and Beck 1983).
///
/// A clique of k vertices lies in the (k - 1)-core, so no clique is larger than the largest core number plus 1.
#[derive(Clone, Debug)]
pub(super) struct Degeneracy {
    /// Vertices as they are peeled, smallest remaining degree first.
    pub(super) order: Vec<usize>,
    /// For each vertex: the largest k of a k-core that contains it; 0 for vertices left out.
    pub(super) core: Vec<usize>,
}

impl Degeneracy {
    /// Peels the graph of the vertices `alive`. O(N^2 / 64 + min(edges, edges of the complement)): in a dense graph,
    /// degrees are updated through non-neighbours.
    pub(super) fn of(graph: &BitGraph, alive: &BitSet) -> Self {
        let mut alive = alive.clone();
        let members: Vec<usize> = alive.members().collect();
        let degrees: Vec<usize> =
            members.iter().map(|&vertex| alive.count_within(graph.neighbours(vertex))).collect();
        let pairs = members.len() * members.len().saturating_sub(1);
        let dense = 2 * degrees.iter().sum::<usize>() > pairs;
        let mut queue = Buckets::new(graph.len(), members.len());
        // In reverse order, so that the first of equal vertices is peeled first.
        for (&vertex, &degree) in members.iter().zip(&degrees).rev() {
            queue.insert(vertex, if dense { members.len() - 1 - degree } else { degree });
        }
        let mut order = Vec::with_capacity(members.len());
        let mut core = vec![0; graph.len()];
        let mut largest_core = 0;
        let mut key = if dense { members.len() } else { 0 };
        let mut touched = Vec::new();
        for remaining in (1..=members.len()).rev() {
            let vertex = loop {
                match queue.first(key) {
                    Some(vertex) => break vertex,
                    None if dense => key -= 1,
                    None => key += 1,
                }
            };
            queue.remove(vertex);
            alive.remove(vertex);
            largest_core = largest_core.max(if dense { remaining - 1 - key } else { key });
            core[vertex] = largest_core;
            order.push(vertex);
            touched.clear();
            if dense {
                touched.extend(alive.members_outside(graph.neighbours(vertex)));
            } else {
                touched.extend(alive.members_within(graph.neighbours(vertex)));
                key = key.saturating_sub(1);
            }
            for &other in &touched {
                queue.decrease(other);
            }
        }
        Self { order, core }
    }

    /// No clique has more vertices than this.
    pub(super) fn clique_bound(&self) -> usize {
        self.order.last().map_or(0, |&last| self.core[last] + 1)
    }
}

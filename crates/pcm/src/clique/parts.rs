//! The components of the complement of a kernel. Each gets bounds, and is solved if these leave a gap.

use super::colouring::{Colouring, Lists};
use super::component::complement_components;
use super::local_search::LocalSearch;
use super::propagation::Contradictions;
use super::recolouring::Recolouring;
use super::search::{Outcome, search};
use super::{BitGraph, BitSet, Incumbent, Limits, ROUNDS, greedy, kernel};

/// Rounds of local search without success on a component that still has a gap. They cost less than branch and bound, or
/// than a kernel that keeps too much.
const LAST_ROUNDS: usize = 2000;

/// Components, small ones first. A clique has a part in each, so no clique is larger than the sum of their bounds.
pub(super) struct Parts {
    parts: Vec<Part>,
}

struct Part {
    vertices: Vec<usize>,
    graph: BitGraph,
    /// A clique, in the vertex numbers of the component.
    clique: Vec<usize>,
    upper_bound: usize,
    /// An order in which first fit takes as many colours as the bound.
    order: Vec<usize>,
}

impl Parts {
    /// The components of the vertices `alive`. Local search may start from their vertices in the clique `known`.
    pub(super) fn of(graph: &BitGraph, alive: &BitSet, known: &[usize]) -> Self {
        let mut inside = BitSet::new(graph.len());
        for &vertex in known {
            inside.insert(vertex);
        }
        let mut parts: Vec<Part> = complement_components(graph, alive)
            .into_iter()
            .map(|vertices| Part::of(graph, vertices, &inside))
            .collect();
        parts.sort_by_key(|part| part.vertices.len());
        Self { parts }
    }

    pub(super) fn upper_bound(&self) -> usize {
        self.parts.iter().map(|part| part.upper_bound).sum()
    }

    fn clique(&self) -> Vec<usize> {
        self.parts.iter().flat_map(|part| part.clique.iter().map(|&vertex| part.vertices[vertex])).collect()
    }

    /// Solves one component after the other until the bounds show that nothing exceeds the incumbent. Returns the nodes
    /// visited.
    pub(super) fn solve(&mut self, incumbent: &mut Incumbent, limits: Limits) -> u64 {
        let mut work = 0;
        incumbent.offer(self.clique());
        let mut total = self.upper_bound();
        for place in 0..self.parts.len() {
            if total <= incumbent.size {
                break;
            }
            let part = &mut self.parts[place];
            if part.clique.len() == part.upper_bound {
                continue;
            }
            // A clique of at most this size here cannot exceed the incumbent, even with all other components at their
            // bounds.
            let others = total - part.upper_bound;
            let known = part.clique.len().max(incumbent.size.saturating_sub(others));
            let outcome = part.solve(known, Limits { work: limits.work.saturating_sub(work), ..limits });
            work += outcome.work;
            part.upper_bound = part.upper_bound.min(outcome.upper_bound);
            total = others + part.upper_bound;
            if let Some(clique) = outcome.clique {
                part.clique = clique;
                incumbent.offer(self.clique());
            }
        }
        work
    }
}

impl Part {
    fn of(graph: &BitGraph, vertices: Vec<usize>, known: &BitSet) -> Self {
        if let [_] = vertices[..] {
            return Self {
                vertices,
                graph: BitGraph::new(1),
                clique: vec![0],
                upper_bound: 1,
                order: vec![0],
            };
        }
        let graph = graph.induced(&vertices);
        let all = BitSet::full(graph.len());
        let mut clique = greedy::fewest_conflicts(&graph, &all);
        let kept: Vec<usize> = (0..vertices.len()).filter(|&place| known.contains(vertices[place])).collect();
        if kept.len() > clique.len() {
            clique = kept;
        }
        let mut bound = Recolouring::of(&graph);
        clique = LocalSearch::new(&graph, &all, &clique).run(bound.colours(), ROUNDS);
        bound.improve(clique.len());
        clique = LocalSearch::new(&graph, &all, &clique).run(bound.colours(), LAST_ROUNDS);
        Self { vertices, graph, clique, upper_bound: bound.colours(), order: bound.order() }
    }

    /// Searches for a clique of more than `known` vertices: in the components of the kernel or, if the kernel keeps nearly
    /// everything, by branch and bound.
    fn solve(&self, known: usize, limits: Limits) -> Outcome {
        if limits.is_over() {
            return Outcome { clique: None, upper_bound: self.upper_bound, work: 0 };
        }
        let conflicts = Lists::of_graph(&self.graph);
        let mut colouring = Colouring::new(self.graph.len());
        colouring.colour(self.order.iter().copied(), &conflicts);
        let contradictions = Contradictions::of(&colouring, &conflicts);
        let bound = colouring.classes.len() - contradictions.count;
        if bound <= known {
            return Outcome { clique: None, upper_bound: bound, work: 0 };
        }
        let mut alive = BitSet::full(self.graph.len());
        kernel::drop_by_classes(&self.graph, &mut alive, colouring, contradictions, known);
        kernel::shrink(&self.graph, &mut alive, known);
        if alive.count() * 20 > self.graph.len() * 19 {
            let outcome = search(&self.graph, known, limits);
            return Outcome { upper_bound: outcome.upper_bound.min(bound), ..outcome };
        }
        let mut incumbent = Incumbent { clique: None, size: known };
        let mut parts = Parts::of(&self.graph, &alive, &self.clique);
        let work = parts.solve(&mut incumbent, limits);
        let upper_bound = parts.upper_bound().max(incumbent.size).min(bound);
        Outcome { upper_bound, clique: incumbent.clique, work }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clique::tests::{drawn, enumerate};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn a_part_whose_clique_and_bound_are_bad_is_solved_all_the_same(
            vertices in 2_usize..=13,
            density in 0.0_f64..1.0,
            draws in proptest::collection::vec(0.0_f64..1.0, 78),
            less in 1_usize..4,
        ) {
            let graph = drawn(vertices, density, &draws);
            let largest = enumerate(&graph);
            let part = Part {
                vertices: (0..vertices).collect(),
                order: (0..vertices).collect(),
                clique: vec![0],
                upper_bound: vertices,
                graph,
            };
            let found = part.solve(largest.saturating_sub(less), Limits::NONE);
            let clique = found.clique.expect("more than was known");
            prop_assert!(part.graph.is_clique(&clique));
            prop_assert_eq!((clique.len(), found.upper_bound), (largest, largest));
            let proof = part.solve(largest, Limits::NONE);
            prop_assert!(proof.clique.is_none() && proof.upper_bound == largest);
        }
    }
}

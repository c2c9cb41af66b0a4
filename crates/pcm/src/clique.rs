//! Maximum cliques of consistency graphs.
//!
//! Consistency graphs are dense: most true edges agree with each other. The search therefore works on the
//! complement first: a clique is a set without edges of the complement, whose connected components can be
//! solved apart, and a vertex that agrees with all others is a component of its own. What remains is
//! searched by branch and bound with greedy colouring as bound (Tomita and Seki 2003; bit-parallel as San
//! Segundo, Rodriguez-Losada, Jimenez 2011).

mod bits;
mod component;
mod search;

pub use bits::BitGraph;

use bits::BitSet;
use component::complement_components;
use search::Search;

/// A clique and what is known about larger ones.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MaximumClique {
    /// Vertices that are all connected with each other, ascending.
    pub vertices: Vec<usize>,
    /// No clique has more vertices than this.
    pub upper_bound: usize,
    /// Branch-and-bound nodes visited.
    pub work: u64,
}

impl MaximumClique {
    /// Whether it is proved that none is larger.
    pub fn is_optimal(&self) -> bool {
        self.vertices.len() == self.upper_bound
    }
}

/// The maximum clique, or after `work_limit` branch-and-bound nodes the largest found and a proved upper
/// bound. Exponential in the worst case; the same answer on every run and machine.
pub fn maximum_clique(graph: &BitGraph, work_limit: u64) -> MaximumClique {
    let mut result = MaximumClique { vertices: Vec::new(), upper_bound: 0, work: 0 };
    for component in complement_components(graph) {
        if let [vertex] = component[..] {
            result.vertices.push(vertex);
            result.upper_bound += 1;
            continue;
        }
        let mut search = Search::new(graph, component, work_limit.saturating_sub(result.work));
        search.run();
        result.work += search.work;
        result.upper_bound += search.upper_bound();
        result.vertices.append(&mut search.best);
    }
    result.vertices.sort_unstable();
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const UNLIMITED: u64 = u64::MAX;

    fn graph(vertices: usize, edges: &[(usize, usize)]) -> BitGraph {
        let mut graph = BitGraph::new(vertices);
        for &(a, b) in edges {
            graph.connect(a, b);
        }
        graph
    }

    fn is_clique(graph: &BitGraph, vertices: &[usize]) -> bool {
        vertices
            .iter()
            .enumerate()
            .all(|(place, &a)| vertices[place + 1..].iter().all(|&b| graph.connected(a, b)))
    }

    /// The size of the largest clique, by trying every subset.
    fn enumerate(graph: &BitGraph) -> usize {
        (0_u32..1 << graph.len())
            .filter(|subset| {
                let members: Vec<usize> =
                    (0..graph.len()).filter(|vertex| subset >> vertex & 1 == 1).collect();
                is_clique(graph, &members)
            })
            .map(u32::count_ones)
            .max()
            .unwrap_or(0) as usize
    }

    #[test]
    fn the_empty_graph_has_the_empty_clique() {
        let clique = maximum_clique(&BitGraph::new(0), UNLIMITED);
        assert!(clique.vertices.is_empty() && clique.is_optimal());
    }

    #[test]
    fn four_vertices_on_which_a_published_heuristic_returns_no_clique() {
        let graph = graph(4, &[(0, 1), (0, 2), (0, 3), (1, 3)]);
        assert_eq!(maximum_clique(&graph, UNLIMITED).vertices, [0, 1, 3]);
    }

    #[test]
    fn a_work_limit_leaves_a_clique_and_a_valid_bound() {
        // Complement of a perfect matching plus noise: greedy alone does not prove anything.
        let mut graph = BitGraph::new(60);
        for a in 0..60_usize {
            for b in a + 1..60 {
                if (a * 7 + b * 13) % 5 != 0 {
                    graph.connect(a, b);
                }
            }
        }
        let exact = maximum_clique(&graph, UNLIMITED);
        let limited = maximum_clique(&graph, 1);
        assert!(exact.is_optimal() && is_clique(&graph, &limited.vertices));
        assert!(limited.vertices.len() <= exact.vertices.len());
        assert!(limited.upper_bound >= exact.vertices.len(), "a bound below the optimum would be a lie");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn the_search_agrees_with_enumeration(
            vertices in 0_usize..=13,
            density in 0.0_f64..1.0,
            draws in proptest::collection::vec(0.0_f64..1.0, 78),
        ) {
            let mut graph = BitGraph::new(vertices);
            let mut draw = draws.iter();
            for a in 0..vertices {
                for b in a + 1..vertices {
                    if *draw.next().unwrap() < density {
                        graph.connect(a, b);
                    }
                }
            }
            let clique = maximum_clique(&graph, UNLIMITED);
            prop_assert!(is_clique(&graph, &clique.vertices));
            prop_assert!(clique.is_optimal());
            prop_assert_eq!(clique.vertices.len(), enumerate(&graph));
        }
    }
}

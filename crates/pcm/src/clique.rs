//! Maximum cliques of consistency graphs, proved optimal.
//!
//! Consistency graphs are dense: most true edges agree with each other. Much of the work is therefore done on the
//! complement, where an edge is a conflict and a clique is a set of vertices without conflicts.
//!
//! 1. Core numbers give an upper bound. Greedy searches, along the reversed degeneracy order and by fewest conflicts, give
//!    the first cliques; local search with (1,2)-swaps enlarges them.
//! 2. Three kinds of vertices are removed: those whose core number is below the incumbent, those that conflict with too
//!    many whole colour classes, and those dominated in the complement.
//! 3. The complement falls apart into components. Each gets a bound of its own (by colours, iterated greedy and
//!    contradictions between colours) and a clique of its own (by local search). Where bound and clique differ, the
//!    component must contribute only as much as the whole needs, beyond the other components, to exceed the incumbent. The
//!    vertices that its kernel keeps are split into components again.
//! 4. If kernels keep nearly everything, branch and bound solves them, with greedy colouring and recolouring (Tomita et al.
//!    2010; bit-parallel as San Segundo, Rodriguez-Losada, Jimenez 2011).
//!
//! The result is deterministic at any number of threads: all numbers are exact, choices follow the order of the vertices,
//! and random draws have a fixed seed. Among cliques of the same size the first one found in this order is taken.
//!
//! Depends on no other module of this crate: it knows graphs, not pose-graph edges.

mod bits;
mod buckets;
mod colouring;
mod component;
mod degeneracy;
pub mod dimacs;
mod greedy;
mod kernel;
mod limits;
mod local_search;
mod parts;
mod propagation;
mod recolouring;
mod search;

pub use bits::BitGraph;
pub use limits::Limits;

pub(crate) use bits::BitSet;
use degeneracy::Degeneracy;
use local_search::LocalSearch;
use parts::Parts;
use search::Outcome;

/// Rounds of local search without success, on the whole graph and on each component.
const ROUNDS: usize = 200;

/// A clique, and an upper bound on the size of any clique.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MaximumClique {
    /// Vertices that are pairwise connected, ascending.
    pub vertices: Vec<usize>,
    /// No clique has more vertices than this.
    pub upper_bound: usize,
    /// Branch-and-bound nodes visited.
    pub work: u64,
}

impl MaximumClique {
    /// Whether it is proved that no clique is larger.
    pub fn is_optimal(&self) -> bool {
        self.vertices.len() == self.upper_bound
    }
}

/// The maximum clique. If a limit ends the search: the largest clique found so far, and a proved upper bound.
///
/// Exponential in the worst case; on consistency graphs of thousands of candidates it usually ends before the first branch.
/// The result is the same on every run and at any number of threads; with a work limit also on every machine.
///
/// ```
/// use posecut_pcm::clique::{BitGraph, Limits, maximum_clique};
/// let mut graph = BitGraph::new(4);
/// for (one, other) in [(0, 1), (0, 2), (0, 3), (1, 3)] {
///     graph.connect(one, other);
/// }
/// let clique = maximum_clique(&graph, Limits::NONE);
/// assert_eq!(clique.vertices, [0, 1, 3]);
/// assert!(clique.is_optimal());
/// ```
pub fn maximum_clique(graph: &BitGraph, limits: Limits) -> MaximumClique {
    let outcome = larger_clique(graph, &BitSet::full(graph.len()), 0, limits);
    let mut vertices = outcome.clique.unwrap_or_default();
    vertices.sort_unstable();
    MaximumClique { vertices, upper_bound: outcome.upper_bound, work: outcome.work }
}

/// The maximum clique among the vertices `alive`, if it has more than `floor` vertices.
pub(crate) fn larger_clique(graph: &BitGraph, alive: &BitSet, floor: usize, limits: Limits) -> Outcome {
    let mut incumbent = Incumbent { clique: None, size: floor };
    let mut alive = alive.clone();
    let degeneracy = Degeneracy::of(graph, &alive);
    // A clique of k vertices lies in the (k - 1)-core. This bound is the cheapest and often equals the first greedy clique.
    let core_bound = degeneracy.clique_bound();
    if core_bound > floor {
        incumbent.offer(greedy::along_degeneracy(graph, &degeneracy));
        kernel::keep_core(&degeneracy, &mut alive, incumbent.size);
        incumbent.offer(greedy::fewest_conflicts(graph, &alive));
        kernel::keep_core(&degeneracy, &mut alive, incumbent.size);
    }
    if core_bound <= incumbent.size || alive.is_empty() {
        return Outcome { upper_bound: incumbent.size, clique: incumbent.clique, work: 0 };
    }
    // Local search runs before the kernel: a larger clique lets the reductions, the expensive step, remove more vertices.
    if let Some(clique) = &incumbent.clique {
        let mut around = alive.clone();
        for &vertex in clique {
            around.insert(vertex);
        }
        let better = LocalSearch::new(graph, &around, clique).run(core_bound, ROUNDS);
        incumbent.offer(better);
    }
    kernel::shrink(graph, &mut alive, incumbent.size);
    let mut parts = Parts::of(graph, &alive, incumbent.clique.as_deref().unwrap_or_default());
    let work = parts.solve(&mut incumbent, limits);
    // Vertices that the kernel removed are in no clique larger than the incumbent, so the bound of the components holds for
    // the whole graph.
    let upper_bound = parts.upper_bound().min(core_bound).max(incumbent.size);
    Outcome { clique: incumbent.clique, upper_bound, work }
}

/// The largest clique so far, or a size that is known without a clique.
struct Incumbent {
    clique: Option<Vec<usize>>,
    size: usize,
}

impl Incumbent {
    fn offer(&mut self, clique: Vec<usize>) {
        if clique.len() > self.size {
            self.size = clique.len();
            self.clique = Some(clique);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn graph(vertices: usize, edges: &[(usize, usize)]) -> BitGraph {
        let mut graph = BitGraph::new(vertices);
        for &(a, b) in edges {
            graph.connect(a, b);
        }
        graph
    }

    /// A random graph: two vertices are connected if their draw is below the density.
    pub(super) fn drawn(vertices: usize, density: f64, draws: &[f64]) -> BitGraph {
        let mut graph = BitGraph::new(vertices);
        let mut draw = draws.iter();
        for a in 0..vertices {
            for b in a + 1..vertices {
                if *draw.next().unwrap() < density {
                    graph.connect(a, b);
                }
            }
        }
        graph
    }

    /// The complement of a ring of five, in five copies that are all connected. A clique takes two vertices of each ring, a
    /// colouring needs three colours for it.
    pub(super) fn rings() -> BitGraph {
        let mut graph = BitGraph::new(25);
        for a in 0..25_usize {
            for b in a + 1..25 {
                let ring = a / 5 == b / 5 && (b - a == 1 || b - a == 4);
                if !ring {
                    graph.connect(a, b);
                }
            }
        }
        graph
    }

    /// The size of the largest clique, by trying every subset.
    pub(super) fn enumerate(graph: &BitGraph) -> usize {
        (0_u32..1 << graph.len())
            .filter(|subset| {
                let members: Vec<usize> =
                    (0..graph.len()).filter(|vertex| subset >> vertex & 1 == 1).collect();
                graph.is_clique(&members)
            })
            .map(u32::count_ones)
            .max()
            .unwrap_or(0) as usize
    }

    #[test]
    fn the_empty_graph_has_the_empty_clique() {
        let clique = maximum_clique(&BitGraph::new(0), Limits::NONE);
        assert!(clique.vertices.is_empty() && clique.is_optimal());
    }

    #[test]
    fn four_vertices_on_which_a_published_heuristic_returns_no_clique() {
        let graph = graph(4, &[(0, 1), (0, 2), (0, 3), (1, 3)]);
        assert_eq!(maximum_clique(&graph, Limits::NONE).vertices, [0, 1, 3]);
    }

    #[test]
    fn a_work_limit_leaves_a_clique_and_a_valid_bound() {
        // The complement of a perfect matching plus noise: greedy search alone proves nothing.
        let mut graph = BitGraph::new(60);
        for a in 0..60_usize {
            for b in a + 1..60 {
                if (a * 7 + b * 13) % 5 != 0 {
                    graph.connect(a, b);
                }
            }
        }
        let exact = maximum_clique(&graph, Limits::NONE);
        let limited = maximum_clique(&graph, Limits::work(1));
        assert!(exact.is_optimal() && graph.is_clique(&limited.vertices));
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
            let graph = drawn(vertices, density, &draws);
            let clique = maximum_clique(&graph, Limits::NONE);
            prop_assert!(graph.is_clique(&clique.vertices));
            prop_assert!(clique.is_optimal());
            prop_assert_eq!(clique.vertices.len(), enumerate(&graph));
        }
    }
}

//! Maximum cliques of consistency graphs, with a proof.
//!
//! Consistency graphs are dense: most true edges agree with each other. Much of the work is therefore done on the
//! complement, whose edges are conflicts: a clique is a set of vertices without conflicts.
//!
//! 1. Upper bound by core numbers; first cliques greedily along the reversed degeneracy order and by fewest conflicts;
//!    local search with (1,2)-swaps.
//! 2. Vertices whose core number is below the incumbent go, those that conflict with too many colour classes as a whole,
//!    and those dominated in the complement.
//! 3. The complement falls apart into components, which are solved one by one by branch and bound with greedy colouring
//!    and recolouring (Tomita et al. 2010; bit-parallel as San Segundo, Rodriguez-Losada, Jimenez 2011). A component is
//!    searched only for what it must bring for the whole to exceed the incumbent.
//!
//! Every number on the way is exact, every choice goes by the order of the vertices, and random draws have a fixed
//! seed: one graph, one answer, at any number of threads. Among cliques of the same size the first one found in this
//! order is taken.

mod bits;
mod buckets;
mod colouring;
mod component;
mod degeneracy;
mod greedy;
mod kernel;
mod limits;
mod local_search;
mod recolouring;
mod search;

pub use bits::BitGraph;
pub use limits::Limits;

pub(crate) use bits::BitSet;
use component::complement_components;
use degeneracy::Degeneracy;
use local_search::LocalSearch;
use recolouring::fewer_colours;
use search::{Outcome, colour_bound, search};

/// Rounds of local search without success, on the whole graph and on each component.
const ROUNDS: usize = 200;

/// A clique and what is known about larger ones.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
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

/// The maximum clique, or when a limit ends the search the largest found and a proved upper bound.
///
/// Exponential in the worst case; on consistency graphs of thousands of candidates it usually ends before the first
/// branch. The same answer on every run and number of threads, and with a work limit on every machine.
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

/// The maximum clique among the vertices `alive`, if it has more than `floor` of them.
pub(crate) fn larger_clique(graph: &BitGraph, alive: &BitSet, floor: usize, limits: Limits) -> Outcome {
    let mut incumbent = Incumbent { clique: None, size: floor };
    let mut alive = alive.clone();
    let degeneracy = Degeneracy::of(graph, &alive);
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
    if let Some(clique) = &incumbent.clique {
        let mut around = alive.clone();
        for &vertex in clique {
            around.insert(vertex);
        }
        let better = LocalSearch::new(graph, &around, clique).run(core_bound, ROUNDS);
        incumbent.offer(better);
    }
    shrink(graph, &mut alive, incumbent.size);
    let mut parts = Parts::of(graph, &alive);
    let work = parts.solve(&mut incumbent, limits);
    let upper_bound = parts.upper_bound().min(core_bound).max(incumbent.size);
    Outcome { clique: incumbent.clique, upper_bound, work }
}

/// Drops vertices by core numbers, by colours and by dominance until none of them finds any.
fn shrink(graph: &BitGraph, alive: &mut BitSet, incumbent: usize) {
    loop {
        let before = alive.count();
        let degeneracy = Degeneracy::of(graph, alive);
        kernel::keep_core(&degeneracy, alive, incumbent);
        kernel::drop_by_colours(graph, alive, &degeneracy, incumbent);
        if alive.count() * 10 < before * 9 {
            // Dominance takes longest, and is quicker on less.
            continue;
        }
        kernel::drop_dominated(graph, alive);
        if alive.count() == before {
            return;
        }
    }
}

/// The largest clique so far, or a size that is known without one.
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

/// The components of the complement of the kernel.
struct Parts {
    parts: Vec<Part>,
}

struct Part {
    vertices: Vec<usize>,
    graph: BitGraph,
    /// A clique, in the part's own numbers.
    clique: Vec<usize>,
    upper_bound: usize,
}

impl Parts {
    fn of(graph: &BitGraph, alive: &BitSet) -> Self {
        let mut parts: Vec<Part> = complement_components(graph, alive)
            .into_iter()
            .map(|vertices| Part::of(graph, vertices))
            .collect();
        parts.sort_by_key(|part| part.vertices.len());
        Self { parts }
    }

    fn upper_bound(&self) -> usize {
        self.parts.iter().map(|part| part.upper_bound).sum()
    }

    fn clique(&self) -> Vec<usize> {
        self.parts.iter().flat_map(|part| part.clique.iter().map(|&vertex| part.vertices[vertex])).collect()
    }

    /// Searches part after part, small ones first, until the bounds say that nothing exceeds the incumbent.
    fn solve(&mut self, incumbent: &mut Incumbent, limits: Limits) -> u64 {
        let mut work = 0;
        incumbent.offer(self.clique());
        for place in 0..self.parts.len() {
            let total = self.upper_bound();
            if total <= incumbent.size {
                break;
            }
            let part = &mut self.parts[place];
            if part.clique.len() == part.upper_bound {
                continue;
            }
            // With less than this in here, all other parts at their bounds do not exceed the incumbent.
            let enough = incumbent.size + 1 - (total - part.upper_bound).min(incumbent.size + 1);
            let known = part.clique.len().max(enough.saturating_sub(1));
            let outcome =
                search(&part.graph, known, Limits { work: limits.work.saturating_sub(work), ..limits });
            work += outcome.work;
            part.upper_bound = part.upper_bound.min(outcome.upper_bound);
            if let Some(clique) = outcome.clique {
                part.clique = clique;
                incumbent.offer(self.clique());
            }
        }
        work
    }
}

impl Part {
    fn of(graph: &BitGraph, vertices: Vec<usize>) -> Self {
        if let [_] = vertices[..] {
            return Self { vertices, graph: BitGraph::new(1), clique: vec![0], upper_bound: 1 };
        }
        let graph = graph.induced(&vertices);
        let all = BitSet::full(graph.len());
        let mut upper_bound = colour_bound(&graph);
        let mut clique = greedy::fewest_conflicts(&graph, &all);
        if clique.len() < upper_bound {
            clique = LocalSearch::new(&graph, &all, &clique).run(upper_bound, ROUNDS);
        }
        if clique.len() < upper_bound {
            upper_bound = upper_bound.min(fewer_colours(&graph, clique.len()));
        }
        Self { vertices, graph, clique, upper_bound }
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

    /// A graph that has an edge where a draw is below the density.
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
        // Complement of a perfect matching plus noise: greedy alone does not prove anything.
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

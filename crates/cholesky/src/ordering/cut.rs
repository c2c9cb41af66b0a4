//! Small sets of vertices that separate a graph in two.
//!
//! A cut starts as a level of a breadth-first search, and moves of single vertices improve it. On regular grids the levels are the better
//! starts. On other graphs those are better which a coarser graph gives, whose cut comes from a coarser one in turn (G. Karypis and V.
//! Kumar, "A fast and high quality multilevel scheme for partitioning irregular graphs", 1998). Of both, the cheaper one is taken.

use std::ops::Range;

use super::graph::Graph;

/// The side of a vertex of the separator; the others are 0 and 1.
pub(super) const SEPARATOR: u8 = 2;
/// Largest share of the weight on one side.
pub(super) const LARGEST: f64 = 0.8;
/// How much the weights of the sides count in the cost of a cut, `separator / (side 0 * side 1)^BALANCE`: one that cuts off a fourth costs as
/// much as one in halves whose separator is a quarter larger.
const BALANCE: f64 = 0.75;
/// Coarser graphs give a cut from this number of vertices on.
const WORTH_COARSENING: usize = 500;
/// Vertices of the coarsest graph, and how many searches cut it.
const COARSEST: usize = 80;
const SEARCHES: usize = 8;
/// A graph that keeps more than this share of its vertices is not made coarser.
const WORTH_A_LEVEL: f64 = 0.9;
/// From this number of vertices on, two threads share the work on a graph.
pub(super) const WORTH_THREADS: usize = 5000;

/// A side for every vertex; no edge joins side 0 to side 1.
pub(super) struct Cut {
    pub(super) side: Vec<u8>,
    /// Weights of side 0, of side 1, of the separator.
    pub(super) sizes: [u64; 3],
}

/// A cut of a connected graph. O(edges log vertices).
pub(super) fn cut(graph: &Graph) -> Cut {
    let by_level = || Cut::by_level(graph, 0).improved(graph);
    if graph.vertices() < WORTH_COARSENING {
        return by_level();
    }
    let by_coarser_graphs =
        || by_coarser_graphs(graph, (1.5 * graph.total() as f64 / COARSEST as f64) as u64);
    let (level, coarse) = if graph.vertices() < WORTH_THREADS {
        (by_level(), by_coarser_graphs())
    } else {
        rayon::join(by_level, by_coarser_graphs)
    };
    if coarse.cost() < level.cost() { coarse } else { level }
}

/// A cut of a coarser graph, whose vertices are not heavier than this, improved on the graph. The best of several on the coarsest one.
fn by_coarser_graphs(graph: &Graph, heaviest: u64) -> Cut {
    if graph.vertices() > COARSEST {
        let (coarser, names) = graph.coarser(heaviest);
        if coarser.vertices() as f64 <= WORTH_A_LEVEL * graph.vertices() as f64 {
            let Cut { side, sizes } = by_coarser_graphs(&coarser, heaviest);
            drop(coarser);
            let side = names.into_iter().map(|name| side[name as usize]).collect();
            return Cut { side, sizes }.improved(graph);
        }
    }
    let from = |first: usize| Cut::by_level(graph, first).improved(graph);
    let others = (1..SEARCHES).map(|search| from(search * graph.vertices() / SEARCHES));
    others.fold(from(0), |best, other| if other.cost() < best.cost() { other } else { best })
}

impl Cut {
    /// What is to be least: few vertices in the separator, many on both sides.
    pub(super) fn cost(&self) -> f64 {
        cost(self.sizes)
    }

    /// The cheapest level of a breadth-first search of a connected graph. The search begins at an end, which searches from `first` find.
    fn by_level(graph: &Graph, first: usize) -> Self {
        let vertices = graph.vertices();
        let mut order = search(graph, first).0;
        // Twice from the last vertex found: this vertex is at an end of the graph, or near it.
        for _ in 0..2 {
            order = search(graph, order[vertices - 1] as usize).0;
        }
        let (order, levels) = search(graph, order[vertices - 1] as usize);
        let (level, sizes) = cheapest(graph, &order, levels);
        let mut side = vec![1; vertices];
        for (place, &vertex) in order.iter().enumerate().take(level.end) {
            side[vertex as usize] = if place < level.start { 0 } else { SEPARATOR };
        }
        Self { side, sizes }
    }

    /// Moves a vertex to a side or into the separator.
    pub(super) fn set(&mut self, graph: &Graph, vertex: usize, side: u8) {
        let weight = u64::from(graph.weight(vertex));
        self.sizes[usize::from(self.side[vertex])] -= weight;
        self.sizes[usize::from(side)] += weight;
        self.side[vertex] = side;
    }
}

/// The cost of a cut with these weights.
fn cost(sizes: [u64; 3]) -> f64 {
    let [first, second, separator] = sizes.map(|size| size as f64);
    if first == 0.0 || second == 0.0 { f64::INFINITY } else { separator / (first * second).powf(BALANCE) }
}

/// The cheapest level of a search that leaves neither side too large, with the weights of its cut; the middle one if there is none.
fn cheapest(graph: &Graph, order: &[u32], levels: Vec<Range<usize>>) -> (Range<usize>, [u64; 3]) {
    let total = graph.total();
    let limit = LARGEST * total as f64;
    let mut before = 0;
    let (mut least, mut best, mut middle) = (f64::INFINITY, None, None);
    for level in levels {
        let size = order[level.clone()].iter().map(|&vertex| u64::from(graph.weight(vertex as usize))).sum();
        let sizes = [before, total - before - size, size];
        before += size;
        if sizes[0].max(sizes[1]) as f64 <= limit && cost(sizes) < least {
            least = cost(sizes);
            best = Some((level.clone(), sizes));
        }
        if middle.is_none() && 2 * before >= total {
            middle = Some((level, sizes));
        }
    }
    best.or(middle).unwrap_or((0..order.len(), [0, 0, total]))
}

/// Vertices in the order of a breadth-first search, and its levels.
fn search(graph: &Graph, first: usize) -> (Vec<u32>, Vec<Range<usize>>) {
    let mut seen = vec![false; graph.vertices()];
    seen[first] = true;
    let mut order = Vec::with_capacity(graph.vertices());
    order.push(first as u32);
    let mut levels = Vec::new();
    let mut start = 0;
    while start < order.len() {
        let end = order.len();
        levels.push(start..end);
        for place in start..end {
            for &neighbour in graph.of(order[place] as usize) {
                if !seen[neighbour as usize] {
                    seen[neighbour as usize] = true;
                    order.push(neighbour);
                }
            }
        }
        start = end;
    }
    (order, levels)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// The edges of a grid in space.
    pub(in crate::ordering) fn grid(side: usize) -> Vec<(usize, usize)> {
        let at = |x: usize, y: usize, z: usize| (z * side + y) * side + x;
        let mut pairs = Vec::new();
        for z in 0..side {
            for y in 0..side {
                for x in 0..side {
                    let here = at(x, y, z);
                    let ahead = [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)];
                    let inside = ahead.into_iter().filter(|&(x, y, z)| x.max(y).max(z) < side);
                    pairs.extend(inside.map(|(x, y, z)| (here, at(x, y, z))));
                }
            }
        }
        pairs
    }

    /// The edges of a walk of so many steps on a grid in the plane with one edge to the place's last visit: irregular, as a pose graph is.
    fn walk(steps: usize) -> Vec<(usize, usize)> {
        let (mut x, mut y, mut state) = (0_i64, 0_i64, 1_u64);
        let mut visits = std::collections::HashMap::from([((0, 0), 0)]);
        let mut pairs = Vec::new();
        for step in 1..steps {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let (ahead, along) = ((state >> 33) % 2 == 0, (state >> 40) % 2 == 0);
            let change = if ahead { 1 } else { -1 };
            if along {
                x = (x + change).clamp(-20, 20);
            } else {
                y = (y + change).clamp(-20, 20);
            }
            pairs.push((step - 1, step));
            if let Some(before) = visits.insert((x, y), step)
                && before + 1 < step
            {
                pairs.push((before, step));
            }
        }
        pairs
    }

    #[test]
    fn no_edge_crosses_a_separator_and_sizes_are_those_of_the_sides() {
        let path = (1..500).map(|vertex| (vertex - 1, vertex)).collect();
        let star = (1..300).map(|vertex| (0, vertex)).collect();
        let complete = (0..30).flat_map(|a| (a + 1..30).map(move |b| (a, b))).collect();
        for (vertices, pairs) in
            [(1000, grid(10)), (8000, grid(20)), (500, path), (300, star), (30, complete), (3000, walk(3000))]
        {
            let graph = Graph::new(vertices, &pairs);
            let cuts = [cut(&graph), Cut::by_level(&graph, 0), by_coarser_graphs(&graph, 20)];
            for cut in &cuts {
                for &(a, b) in &pairs {
                    let (a, b) = (cut.side[a], cut.side[b]);
                    assert!(a == b || a == SEPARATOR || b == SEPARATOR, "{vertices}");
                }
                for side in 0..3_u8 {
                    let count = cut.side.iter().map(|&other| u64::from(other == side)).sum::<u64>();
                    assert_eq!(count, cut.sizes[usize::from(side)], "{vertices}");
                }
            }
            assert!(cuts.iter().all(|other| cuts[0].cost() <= other.cost()), "{vertices}");
        }
    }

    #[test]
    fn a_strip_is_cut_across() {
        // 100 vertices long, 4 wide.
        let pairs: Vec<_> = (0..400)
            .flat_map(|vertex| [(vertex, vertex + 4), (vertex, vertex + 1)])
            .filter(|&(a, b)| b < 400 && (b == a + 4 || b % 4 > 0))
            .collect();
        let graph = Graph::new(400, &pairs);
        for cut in [cut(&graph), by_coarser_graphs(&graph, 8)] {
            assert!(cut.sizes[2] == 4 && cut.sizes[0].abs_diff(cut.sizes[1]) < 100, "{:?}", cut.sizes);
        }
    }

    #[test]
    fn on_an_irregular_graph_coarser_graphs_cut_better_than_levels() {
        let graph = Graph::new(3000, &walk(3000));
        let (level, coarse) = (Cut::by_level(&graph, 0), by_coarser_graphs(&graph, 60));
        let improved = Cut::by_level(&graph, 0).improved(&graph);
        println!("{:?} {:?} {:?}", level.sizes, improved.sizes, coarse.sizes);
        assert!(improved.cost() < level.cost() && coarse.cost() < improved.cost());
    }
}

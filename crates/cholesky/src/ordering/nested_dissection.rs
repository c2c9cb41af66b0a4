//! Nested dissection: a small set of variables that separates the graph in two comes last, and each side is ordered likewise.
//!
//! A. George, "Nested dissection of a regular finite element mesh", 1973. A separator starts as a level of a breadth-first
//! search from an end of the graph. Moves of single vertices improve it, in the manner of C. M. Fiduccia and R. M.
//! Mattheyses, "A linear-time heuristic for improving network partitions", 1982, but on vertices instead of edges. Minimum
//! degree orders small subgraphs.

use super::minimum_degree::approximate_minimum_degree;
use crate::Adjacency;

/// Minimum degree orders subgraphs with at most this many vertices.
const SMALL: usize = 120;
/// From this number of vertices on, two threads order the two sides.
const WORTH_THREADS: usize = 5000;
/// Vertices with more neighbours than this, times the square root of the number of vertices, come last: no small level of a search
/// leaves out a hub's neighbours. The limit is that of minimum degree for dense rows.
const HUB: f64 = 10.0;
/// Largest share of the vertices on one side.
const BALANCE: f64 = 0.6;
/// Number of improvement passes, and number of moves without gain after which a pass ends.
const PASSES: usize = 6;
const PATIENCE: usize = 60;
/// The side of a vertex of the separator; the others are 0 and 1.
const SEPARATOR: u8 = 2;

/// The order of elimination, `order[position] = variable`. Every pair is given once. Depends on the pattern alone.
pub(crate) fn nested_dissection(variables: usize, pairs: &[(usize, usize)]) -> Vec<usize> {
    let all = Part { names: (0..variables).collect(), pairs: pairs.to_vec() };
    let most = (HUB * (variables as f64).sqrt()) as usize;
    let hubs: Vec<usize> = all.degrees().into_iter().map(|degree| usize::from(degree > most)).collect();
    if !hubs.contains(&1) {
        return dissect(&all);
    }
    let mut parts = all.split(&hubs, 2);
    let mut order = dissect(&parts.swap_remove(0));
    order.extend((0..variables).filter(|&variable| hubs[variable] == 1));
    order
}

/// A subgraph: the variables of its vertices in ascending order, and its edges by index in them, the smaller one first.
#[derive(Default)]
struct Part {
    names: Vec<usize>,
    pairs: Vec<(usize, usize)>,
}

impl Part {
    fn degrees(&self) -> Vec<usize> {
        let mut degrees = vec![0; self.names.len()];
        for &(a, b) in &self.pairs {
            degrees[a] += 1;
            degrees[b] += 1;
        }
        degrees
    }

    /// The subgraphs of the vertices with equal labels below `count`.
    fn split(&self, labels: &[usize], count: usize) -> Vec<Self> {
        let mut parts: Vec<Self> = (0..count).map(|_| Self::default()).collect();
        let mut place = vec![0; self.names.len()];
        for (vertex, &name) in self.names.iter().enumerate() {
            if let Some(part) = parts.get_mut(labels[vertex]) {
                place[vertex] = part.names.len();
                part.names.push(name);
            }
        }
        for &(a, b) in &self.pairs {
            if labels[a] == labels[b]
                && let Some(part) = parts.get_mut(labels[a])
            {
                part.pairs.push((place[a], place[b]));
            }
        }
        parts
    }
}

/// The order of a subgraph.
fn dissect(part: &Part) -> Vec<usize> {
    let (names, pairs) = (&part.names, &part.pairs);
    if names.len() <= SMALL {
        let order = approximate_minimum_degree(names.len(), pairs);
        return order.into_iter().map(|vertex| names[vertex]).collect();
    }
    let graph = Adjacency::new(names.len(), pairs.iter().flat_map(|&(a, b)| [(a, b), (b, a)]));
    let (components, count) = components(&graph, names.len());
    if count > 1 {
        drop(graph);
        return part.split(&components, count).iter().flat_map(dissect).collect();
    }
    let mut cut = Cut::by_levels(&graph, names.len());
    cut.improve(&graph);
    drop(graph);
    let sides: Vec<usize> = cut.side.into_iter().map(usize::from).collect();
    let parts = part.split(&sides, 2);
    let (mut order, second) = if names.len() < WORTH_THREADS {
        (dissect(&parts[0]), dissect(&parts[1]))
    } else {
        rayon::join(|| dissect(&parts[0]), || dissect(&parts[1]))
    };
    order.extend(second);
    order.extend(
        names.iter().zip(&sides).filter(|(_, side)| **side == usize::from(SEPARATOR)).map(|(&name, _)| name),
    );
    order
}

/// The number of every vertex's connected component, and how many there are.
fn components(graph: &Adjacency, vertices: usize) -> (Vec<usize>, usize) {
    let mut component = vec![usize::MAX; vertices];
    let (mut count, mut waiting) = (0, Vec::new());
    for start in 0..vertices {
        if component[start] != usize::MAX {
            continue;
        }
        component[start] = count;
        waiting.push(start);
        while let Some(vertex) = waiting.pop() {
            for &neighbour in graph.of(vertex) {
                if component[neighbour] == usize::MAX {
                    component[neighbour] = count;
                    waiting.push(neighbour);
                }
            }
        }
        count += 1;
    }
    (component, count)
}

/// A side for every vertex; no edge joins side 0 to side 1.
struct Cut {
    side: Vec<u8>,
    /// Vertices on side 0, on side 1, in the separator.
    sizes: [usize; 3],
}

impl Cut {
    /// The smallest level near the middle of a breadth-first search of a connected graph.
    fn by_levels(graph: &Adjacency, vertices: usize) -> Self {
        let mut order = search(graph, vertices, 0).0;
        // Twice from the last vertex found: this vertex is at an end of the graph, or near it.
        for _ in 0..2 {
            order = search(graph, vertices, order[order.len() - 1]).0;
        }
        let (order, levels) = search(graph, vertices, order[order.len() - 1]);
        let mut side = vec![1; vertices];
        let balanced = |level: &&std::ops::Range<usize>| {
            level.start.max(vertices - level.end) as f64 <= BALANCE * vertices as f64
        };
        let middle = |level: &&std::ops::Range<usize>| level.end > vertices / 2;
        let level = levels.iter().filter(balanced).min_by_key(|level| level.len());
        let level = level.or_else(|| levels.iter().find(middle)).cloned().unwrap_or(0..vertices);
        for (place, &vertex) in order.iter().enumerate() {
            side[vertex] = if place < level.start {
                0
            } else if level.contains(&place) {
                SEPARATOR
            } else {
                1
            };
        }
        Self { side, sizes: [level.start, vertices - level.end, level.len()] }
    }

    /// Moves vertices out of the separator, and their neighbours on the other side into it, as long as a pass shrinks it.
    fn improve(&mut self, graph: &Adjacency) {
        let limit = (BALANCE * self.side.len() as f64) as usize;
        for _ in 0..PASSES {
            if self.sizes[2] == 0 {
                return;
            }
            let mut members: Vec<usize> =
                (0..self.side.len()).filter(|&vertex| self.side[vertex] == SEPARATOR).collect();
            let mut locked = vec![false; self.side.len()];
            let mut undo: Vec<(usize, u8)> = Vec::new();
            let start = (self.sizes[2], self.sizes[0].abs_diff(self.sizes[1]));
            let (mut best, mut best_at, mut idle) = (start, 0, 0);
            while idle < PATIENCE {
                members.retain(|&vertex| self.side[vertex] == SEPARATOR && !locked[vertex]);
                let Some((vertex, to)) = self.best_move(graph, &members, limit) else { break };
                let other = 1 - to;
                locked[vertex] = true;
                undo.push((vertex, SEPARATOR));
                self.set(vertex, to);
                for &neighbour in graph.of(vertex) {
                    if self.side[neighbour] == other {
                        undo.push((neighbour, other));
                        self.set(neighbour, SEPARATOR);
                        members.push(neighbour);
                    }
                }
                let now = (self.sizes[2], self.sizes[0].abs_diff(self.sizes[1]));
                if now < best {
                    (best, best_at, idle) = (now, undo.len(), 0);
                } else {
                    idle += 1;
                }
            }
            for (vertex, side) in undo.drain(best_at..).rev() {
                self.set(vertex, side);
            }
            if best >= start {
                return;
            }
        }
    }

    /// The move that shrinks the separator most; if two are equal, the one to the smaller side.
    fn best_move(&self, graph: &Adjacency, members: &[usize], limit: usize) -> Option<(usize, u8)> {
        let mut best: Option<((usize, usize, usize), u8)> = None;
        for &vertex in members {
            let mut across = [0_usize; 2];
            for &neighbour in graph.of(vertex) {
                if let Some(count) = across.get_mut(usize::from(self.side[neighbour])) {
                    *count += 1;
                }
            }
            for to in [0, 1_u8] {
                let size = self.sizes[usize::from(to)];
                let key = (across[usize::from(1 - to)], size, vertex);
                if size < limit && best.is_none_or(|(least, _)| key < least) {
                    best = Some((key, to));
                }
            }
        }
        best.map(|((_, _, vertex), to)| (vertex, to))
    }

    fn set(&mut self, vertex: usize, side: u8) {
        self.sizes[usize::from(self.side[vertex])] -= 1;
        self.sizes[usize::from(side)] += 1;
        self.side[vertex] = side;
    }
}

/// Vertices in the order of a breadth-first search, and its levels.
fn search(graph: &Adjacency, vertices: usize, first: usize) -> (Vec<usize>, Vec<std::ops::Range<usize>>) {
    let mut seen = vec![false; vertices];
    seen[first] = true;
    let mut order = vec![first];
    let mut levels = Vec::new();
    let mut start = 0;
    while start < order.len() {
        let end = order.len();
        levels.push(start..end);
        for place in start..end {
            for &neighbour in graph.of(order[place]) {
                if !seen[neighbour] {
                    seen[neighbour] = true;
                    order.push(neighbour);
                }
            }
        }
        start = end;
    }
    (order, levels)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Symbolic;

    fn grid(side: usize) -> Vec<(usize, usize)> {
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

    #[test]
    fn every_variable_has_one_place_and_no_edge_crosses_a_separator() {
        for (variables, pairs) in [
            (1000, grid(10)),
            (500, (1..500).map(|vertex| (vertex - 1, vertex)).collect()),
            (400, Vec::new()),
            (300, (1..300).map(|vertex| (0, vertex)).collect()),
        ] {
            let mut order = nested_dissection(variables, &pairs);
            order.sort_unstable();
            assert_eq!(order, (0..variables).collect::<Vec<_>>());
            if pairs.is_empty() {
                continue;
            }
            let graph = Adjacency::new(variables, pairs.iter().flat_map(|&(a, b)| [(a, b), (b, a)]));
            let mut cut = Cut::by_levels(&graph, variables);
            cut.improve(&graph);
            for &(a, b) in &pairs {
                assert!(cut.side[a] == cut.side[b] || cut.side[a] == SEPARATOR || cut.side[b] == SEPARATOR);
            }
            for side in 0..3_u8 {
                let count = cut.side.iter().map(|&other| usize::from(other == side)).sum::<usize>();
                assert_eq!(count, cut.sizes[usize::from(side)]);
            }
        }
    }

    #[test]
    fn a_spatial_grid_takes_fewer_operations_than_by_minimum_degree() {
        let pairs = grid(14);
        let variables = 14 * 14 * 14;
        let flops = |order: &[usize]| Symbolic::with_order(&pairs, order, 6).flops();
        let degree = flops(&approximate_minimum_degree(variables, &pairs));
        let dissected = flops(&nested_dissection(variables, &pairs));
        assert!(dissected < 0.8 * degree, "{dissected:e} {degree:e}");
    }

    /// Every component that a separator leaves was a level of recursion, and each level kept a list of all that remain.
    #[test]
    fn a_hundred_thousand_leaves_of_one_hub_took_quadratic_memory() {
        let leaves = 100_000;
        let mut pairs = grid(10);
        pairs.extend((0..leaves).map(|leaf| (0, 1000 + leaf)));
        pairs.sort_unstable();
        let mut order = nested_dissection(1000 + leaves, &pairs);
        order.sort_unstable();
        assert!(order.into_iter().eq(0..1000 + leaves));
    }
}

//! Nested dissection: a small set of variables that separates the graph in two comes last, and each side is ordered likewise.
//!
//! A. George, "Nested dissection of a regular finite element mesh", 1973. [`cut`](super::cut) finds the separators. Minimum degree orders
//! small subgraphs, with regard to the separators around them.

use super::cut::{SEPARATOR, WORTH_THREADS, cut};
use super::exact_minimum_degree::exact_minimum_degree;
use super::graph::Graph;

/// Minimum degree orders subgraphs with at most this many vertices.
const SMALL: usize = 200;
/// Vertices with more neighbours than this, times the square root of the number of vertices, come last: no small level of a search
/// leaves out a hub's neighbours. The limit is that of minimum degree for dense rows.
const HUB: f64 = 10.0;

/// The order of elimination, `order[position] = variable`. Every pair is given once. Depends on the pattern alone.
pub(crate) fn nested_dissection(variables: usize, pairs: &[(usize, usize)]) -> Vec<usize> {
    let all = Graph::new(variables, pairs);
    let most = (HUB * (variables as f64).sqrt()) as usize;
    let is_hub = |variable: usize| all.of(variable).len() > most;
    let labels: Vec<usize> = (0..variables).map(|variable| usize::from(is_hub(variable))).collect();
    let mut order: Vec<usize> =
        all.split(&labels, 1).into_iter().flat_map(|part| dissect(&all, part)).collect();
    order.extend((0..variables).filter(|&variable| is_hub(variable)));
    order
}

/// The order of a part of the graph of all variables: the variables of its vertices in ascending order, and the subgraph of them.
fn dissect(all: &Graph, (names, graph): (Vec<u32>, Graph)) -> Vec<usize> {
    if names.len() <= SMALL {
        return order_small(all, &names);
    }
    let named = |(mut vertices, part): (Vec<u32>, Graph)| {
        for vertex in &mut vertices {
            *vertex = names[*vertex as usize];
        }
        (vertices, part)
    };
    let (components, count) = components(&graph);
    if count > 1 {
        let parts = graph.split(&components, count);
        drop(graph);
        return parts.into_iter().flat_map(|part| dissect(all, named(part))).collect();
    }
    let sides: Vec<usize> = cut(&graph).side.into_iter().map(usize::from).collect();
    let mut parts = graph.split(&sides, 2).into_iter().map(named);
    drop(graph);
    let (first, second) = (parts.next().unwrap_or_default(), parts.next().unwrap_or_default());
    let (mut order, second) = if names.len() < WORTH_THREADS {
        (dissect(all, first), dissect(all, second))
    } else {
        rayon::join(|| dissect(all, first), || dissect(all, second))
    };
    order.extend(second);
    let separator = names.iter().zip(&sides).filter(|(_, side)| **side == usize::from(SEPARATOR));
    order.extend(separator.map(|(&name, _)| name as usize));
    order
}

/// The order of a few variables by minimum degree. Those that are not among them come later.
fn order_small(all: &Graph, names: &[u32]) -> Vec<usize> {
    let mut around: Vec<u32> = names.iter().flat_map(|&name| all.of(name as usize)).copied().collect();
    around.retain(|neighbour| names.binary_search(neighbour).is_err());
    around.sort_unstable();
    around.dedup();
    let place = |name: &u32| {
        let outside = || around.binary_search(name).map(|place| names.len() + place);
        names.binary_search(name).or_else(|_| outside()).ok()
    };
    let edges_at = |(place_of, &name): (usize, &u32)| {
        all.of(name as usize)
            .iter()
            .filter_map(place)
            .map(move |neighbour| (place_of, neighbour))
            .collect::<Vec<_>>()
    };
    let pairs: Vec<(usize, usize)> = names.iter().enumerate().flat_map(edges_at).collect();
    let order = exact_minimum_degree(names.len(), names.len() + around.len(), &pairs);
    order.into_iter().map(|vertex| names[vertex] as usize).collect()
}

/// The number of every vertex's connected component, and how many there are.
fn components(graph: &Graph) -> (Vec<usize>, usize) {
    let mut component = vec![usize::MAX; graph.vertices()];
    let (mut count, mut waiting) = (0, Vec::new());
    for start in 0..graph.vertices() {
        if component[start] != usize::MAX {
            continue;
        }
        component[start] = count;
        waiting.push(start);
        while let Some(vertex) = waiting.pop() {
            for neighbour in graph.of(vertex).iter().map(|&neighbour| neighbour as usize) {
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
#[cfg(test)]
mod tests {
    use super::super::cut::tests::grid;
    use super::super::minimum_degree::approximate_minimum_degree;
    use super::*;
    use crate::Symbolic;

    #[test]
    fn every_variable_has_one_place() {
        for (variables, pairs) in [
            (1000, grid(10)),
            (500, (1..500).map(|vertex| (vertex - 1, vertex)).collect()),
            (400, Vec::new()),
            (300, (1..300).map(|vertex| (0, vertex)).collect()),
            (300, (0..300).flat_map(|a| (a + 1..300).map(move |b| (a, b))).collect()),
            (0, Vec::new()),
        ] {
            let mut order = nested_dissection(variables, &pairs);
            order.sort_unstable();
            assert_eq!(order, (0..variables).collect::<Vec<_>>());
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

//! Colourings with fewer colours: better bounds where one greedy colouring leaves a gap.

use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::colouring::{Colouring, Lists};
use super::degeneracy::Degeneracy;
use super::{BitGraph, BitSet};

/// Rounds without success after which a colouring is left as it is.
const PATIENCE: usize = 300;
/// Conflicts looked at over all rounds: about a tenth of a second.
const EFFORT: usize = 50_000_000;

/// An upper bound on the size of cliques from colourings, found by iterated greedy (Culberson 1992): vertices are coloured
/// again class by class, in another order of the classes, which never takes more colours and now and then takes fewer.
/// Ends at `goal` colours, or when it gets no further.
///
/// A vertex fits into a class if it conflicts with all of it, so that a round goes through the conflicts alone, and
/// takes O(edges of the complement).
pub(super) fn fewer_colours(graph: &BitGraph, goal: usize) -> usize {
    let conflicts = Lists::of_graph(graph);
    let cost = graph.len() + conflicts.len();
    let mut order = Degeneracy::of(graph, &BitSet::full(graph.len())).order;
    order.reverse();
    // A fixed seed: the same graph gives the same bound.
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut colouring = Colouring::new(graph.len());
    colouring.colour(order.iter().copied(), &conflicts);
    let (mut fewest, mut since) = (colouring.classes.len(), 0);
    for _ in 0..EFFORT / cost.max(1) {
        if fewest <= goal || since == PATIENCE {
            break;
        }
        since += 1;
        colouring.shuffle(&mut random);
        order.clear();
        order.extend(colouring.classes.iter().flatten().map(|&vertex| vertex as usize));
        colouring.colour(order.iter().copied(), &conflicts);
        if colouring.classes.len() < fewest {
            (fewest, since) = (colouring.classes.len(), 0);
        }
    }
    fewest
}

impl Colouring {
    /// Another order of the classes: turned round, the largest first, or any.
    fn shuffle(&mut self, random: &mut ChaCha8Rng) {
        match random.random_range(0..10) {
            0..5 => self.classes.reverse(),
            5..8 => self.classes.sort_by_key(|class| std::cmp::Reverse(class.len())),
            _ => self.classes.shuffle(random),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clique::tests::drawn;
    use crate::clique::{Limits, maximum_clique};
    use proptest::prelude::*;

    /// The complement of a ring of five, five times over, all joined: cliques have two of each ring, colourings three.
    #[test]
    fn rings_of_odd_length_keep_their_gap() {
        let mut graph = BitGraph::new(25);
        for a in 0..25_usize {
            for b in a + 1..25 {
                let ring = a / 5 == b / 5 && (b - a == 1 || b - a == 4);
                if !ring {
                    graph.connect(a, b);
                }
            }
        }
        assert_eq!(maximum_clique(&graph, Limits::NONE).vertices.len(), 10);
        assert_eq!(fewer_colours(&graph, 10), 15);
    }

    proptest! {
        #[test]
        fn no_clique_has_more_vertices_than_there_are_colours(
            vertices in 1_usize..40,
            density in 0.0_f64..1.0,
            draws in proptest::collection::vec(0.0_f64..1.0, 780),
        ) {
            let graph = drawn(vertices, density, &draws);
            let largest = maximum_clique(&graph, Limits::NONE).vertices.len();
            prop_assert!(fewer_colours(&graph, 0) >= largest);
        }
    }
}

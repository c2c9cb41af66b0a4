//! Colourings with fewer colours: better bounds where one greedy colouring leaves a gap.

use rand::seq::SliceRandom as _;
use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::colouring::{Colouring, Lists};
use super::degeneracy::Degeneracy;
use super::{BitGraph, BitSet};

/// The search for fewer colours ends after this many rounds without success.
const PATIENCE: usize = 300;
/// The most conflicts examined over all rounds: about a tenth of a second.
const EFFORT: usize = 50_000_000;

/// A colouring of a whole graph that iterated greedy (Culberson 1992) can improve. It colours the vertices again class by
/// class, with the classes in another order. This never takes more colours, and sometimes fewer.
pub(super) struct Recolouring {
    conflicts: Lists,
    colouring: Colouring,
}

impl Recolouring {
    /// First fit along the reversed degeneracy order. O(N^2 / 64 + edges of the complement), as is the memory.
    pub(super) fn of(graph: &BitGraph) -> Self {
        let conflicts = Lists::of_graph(graph);
        let order = Degeneracy::of(graph, &BitSet::full(graph.len())).order;
        let mut colouring = Colouring::new(graph.len());
        colouring.colour(order.into_iter().rev(), &conflicts);
        Self { conflicts, colouring }
    }

    /// No clique has more vertices than this.
    pub(super) fn colours(&self) -> usize {
        self.colouring.classes.len()
    }

    /// The vertices class by class. First fit in this order takes no more colours.
    pub(super) fn order(&self) -> Vec<usize> {
        self.colouring.classes.iter().flatten().map(|&vertex| vertex as usize).collect()
    }

    /// Searches for fewer colours, down to `goal`, until there is no more progress. A round takes O(edges of the
    /// complement).
    pub(super) fn improve(&mut self, goal: usize) {
        // A fixed seed: the same graph gives the same bound.
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut since = 0;
        for _ in 0..EFFORT / self.conflicts.cost() {
            let before = self.colours();
            if before <= goal || since == PATIENCE {
                return;
            }
            self.colouring.shuffle(&mut random);
            self.colouring.colour(self.order(), &self.conflicts);
            since = if self.colours() < before { 0 } else { since + 1 };
        }
    }
}

impl Colouring {
    /// Puts the classes into another order: reversed, the largest first, or random.
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
    use crate::clique::tests::{drawn, rings};
    use crate::clique::{Limits, maximum_clique};
    use proptest::prelude::*;

    #[test]
    fn rings_of_odd_length_keep_their_gap() {
        let graph = rings();
        assert_eq!(maximum_clique(&graph, Limits::NONE).vertices.len(), 10);
        let mut colouring = Recolouring::of(&graph);
        colouring.improve(10);
        assert_eq!(colouring.colours(), 15);
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
            let mut recolouring = Recolouring::of(&graph);
            let first = recolouring.colours();
            recolouring.improve(0);
            let colours = recolouring.colours();
            prop_assert!(largest <= colours && colours <= first);
            let mut again = Colouring::new(vertices);
            again.colour(recolouring.order(), &Lists::of_graph(&graph));
            prop_assert!(again.classes.len() <= colours);
            prop_assert_eq!(again.classes.iter().map(Vec::len).sum::<usize>(), vertices);
        }
    }
}

//! Colourings with fewer colours: better bounds where one greedy colouring leaves a gap.

use rand::{RngExt as _, SeedableRng};
use rand_chacha::ChaCha8Rng;

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
    let all = BitSet::full(graph.len());
    let conflicts: Vec<Vec<u32>> = (0..graph.len())
        .map(|vertex| {
            let outside = all.members_outside(graph.neighbours(vertex));
            outside.filter(|&other| other != vertex).map(|other| other as u32).collect()
        })
        .collect();
    let cost = graph.len() + conflicts.iter().map(Vec::len).sum::<usize>();
    let mut order = Degeneracy::of(graph, &all).order;
    order.reverse();
    // A fixed seed: the same graph gives the same bound.
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut colouring = Colouring::new(graph.len());
    colouring.colour(&order, &conflicts);
    let (mut fewest, mut since) = (colouring.classes.len(), 0);
    for _ in 0..EFFORT / cost.max(1) {
        if fewest <= goal || since == PATIENCE {
            break;
        }
        since += 1;
        colouring.shuffle(&mut random);
        order.clear();
        order.extend(colouring.classes.iter().flatten().map(|&vertex| vertex as usize));
        colouring.colour(&order, &conflicts);
        if colouring.classes.len() < fewest {
            (fewest, since) = (colouring.classes.len(), 0);
        }
    }
    fewest
}

/// Classes of vertices that all conflict with each other.
struct Colouring {
    classes: Vec<Vec<u32>>,
    class_of: Vec<u32>,
    /// For each class how many of its members conflict with the vertex at hand.
    met: Vec<u32>,
}

const UNCOLOURED: u32 = u32::MAX;

impl Colouring {
    fn new(vertices: usize) -> Self {
        Self { classes: Vec::new(), class_of: vec![UNCOLOURED; vertices], met: vec![0; vertices] }
    }

    /// First fit, in the order given.
    fn colour(&mut self, order: &[usize], conflicts: &[Vec<u32>]) {
        self.classes.clear();
        self.class_of.fill(UNCOLOURED);
        for &vertex in order {
            let classes = || conflicts[vertex].iter().map(|&other| self.class_of[other as usize]);
            let mut fitting = UNCOLOURED;
            for class in classes().filter(|&class| class != UNCOLOURED) {
                let met = &mut self.met[class as usize];
                *met += 1;
                if *met as usize == self.classes[class as usize].len() {
                    fitting = fitting.min(class);
                }
            }
            for class in classes().filter(|&class| class != UNCOLOURED) {
                self.met[class as usize] = 0;
            }
            if fitting == UNCOLOURED {
                fitting = self.classes.len() as u32;
                self.classes.push(Vec::new());
            }
            self.classes[fitting as usize].push(vertex as u32);
            self.class_of[vertex] = fitting;
        }
    }

    /// Another order of the classes: turned round, the largest first, or any.
    fn shuffle(&mut self, random: &mut ChaCha8Rng) {
        match random.random_range(0..10) {
            0..5 => self.classes.reverse(),
            5..8 => self.classes.sort_by_key(|class| std::cmp::Reverse(class.len())),
            _ => {
                for place in (1..self.classes.len()).rev() {
                    self.classes.swap(place, random.random_range(0..=place));
                }
            }
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

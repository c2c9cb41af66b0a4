//! Sets of colour classes such that no clique has a vertex in each class of a set.

use super::colouring::{Colouring, Conflicts as _, Lists};

/// The most conflicts examined from one vertex, and in total: about a second.
const STEPS: usize = 100_000;
const EFFORT: usize = 300_000_000;
/// The most members of a class to start from. The more members it has, the more of them must fail.
const MEMBERS: usize = 8;

/// Disjoint sets of classes. No clique has a vertex in each class of a set, so a clique has fewer vertices than there are
/// classes, by at least one for each set.
#[derive(Default)]
pub(super) struct Contradictions {
    /// For each class the set that it belongs to; classes beyond the end have none.
    set_of: Vec<Option<u32>>,
    pub(super) count: usize,
}

impl Contradictions {
    /// Finds contradictions by unit propagation and failed literals, as for MaxSAT (Li, Quan 2010). Suppose that a clique
    /// contains a certain vertex and has one vertex of each class. If all members of a class but one conflict with the
    /// vertices chosen so far, the clique contains that one. If a class has no member left, the classes on the way
    /// contradict each other under this assumption; if every member of the first class leads to a contradiction, they do so
    /// without it. Deterministic; the effort is bounded.
    pub(super) fn of(colouring: &Colouring, conflicts: &Lists) -> Self {
        let mut search = Propagation::new(colouring, conflicts);
        let mut begin: Vec<usize> = (0..colouring.classes.len()).collect();
        begin.sort_by_key(|&class| colouring.classes[class].len());
        for class in begin {
            let members = &colouring.classes[class];
            if members.len() > MEMBERS || search.effort == 0 {
                break;
            }
            if search.found.set_of[class].is_some() {
                continue;
            }
            let mut involved = vec![class as u32];
            if members.iter().all(|&vertex| search.fails(vertex, &mut involved)) {
                let set = search.found.count as u32;
                search.found.count += 1;
                for class in involved {
                    search.found.set_of[class as usize] = Some(set);
                }
            }
        }
        search.found
    }

    /// The number of sets that contain at least one of these classes.
    pub(super) fn touched(&self, classes: impl Iterator<Item = u32>) -> usize {
        let mut sets: Vec<u32> = classes.filter_map(|class| *self.set_of.get(class as usize)?).collect();
        sets.sort_unstable();
        sets.dedup();
        sets.len()
    }

    /// Removes the set of a class that no longer exists.
    pub(super) fn retire(&mut self, class: u32) {
        if let Some(&Some(set)) = self.set_of.get(class as usize) {
            self.count -= 1;
            for other in self.set_of.iter_mut().filter(|other| **other == Some(set)) {
                *other = None;
            }
        }
    }
}

const NONE: u32 = u32::MAX;

struct Propagation<'a> {
    colouring: &'a Colouring,
    conflicts: &'a Lists,
    found: Contradictions,
    effort: usize,
    /// For each excluded vertex: the class whose choice excluded it.
    reason: Vec<u32>,
    /// Excluded vertices.
    trail: Vec<u32>,
    /// For each class: the number of members that are not excluded.
    left: Vec<u32>,
}

impl<'a> Propagation<'a> {
    fn new(colouring: &'a Colouring, conflicts: &'a Lists) -> Self {
        let classes = &colouring.classes;
        Self {
            colouring,
            conflicts,
            found: Contradictions { set_of: vec![None; classes.len()], count: 0 },
            effort: EFFORT,
            reason: vec![NONE; colouring.class_of.len()],
            trail: Vec::new(),
            left: classes.iter().map(|class| class.len() as u32).collect(),
        }
    }

    /// Whether the choice of a vertex leaves some class without members. Adds the classes on the way to `involved`.
    fn fails(&mut self, vertex: u32, involved: &mut Vec<u32>) -> bool {
        let empty = self.propagate(vertex);
        // The choices that excluded the members of a class involve other classes, and so on.
        let mut way: Vec<u32> = empty.into_iter().collect();
        let mut next = 0;
        while let Some(&class) = way.get(next) {
            next += 1;
            for &member in &self.colouring.classes[class as usize] {
                let reason = self.reason[member as usize];
                if reason != NONE && !way.contains(&reason) {
                    way.push(reason);
                }
            }
        }
        involved.append(&mut way);
        for vertex in self.trail.drain(..) {
            self.reason[vertex as usize] = NONE;
            self.left[self.colouring.class_of[vertex as usize] as usize] += 1;
        }
        empty.is_some()
    }

    /// Chooses a vertex and all vertices that follow from it. Stops at a class that has no member left, and returns it.
    fn propagate(&mut self, vertex: u32) -> Option<u32> {
        let mut chosen = vec![vertex];
        let mut next = 0;
        let mut steps = STEPS.min(self.effort);
        while let Some(&vertex) = chosen.get(next) {
            next += 1;
            let own = self.colouring.class_of[vertex as usize];
            for other in self.conflicts.of(vertex as usize) {
                if steps == 0 {
                    return None;
                }
                steps -= 1;
                self.effort -= 1;
                let class = self.colouring.class_of[other];
                if class == own || self.reason[other] != NONE || self.found.set_of[class as usize].is_some() {
                    continue;
                }
                self.reason[other] = own;
                self.trail.push(other as u32);
                self.left[class as usize] -= 1;
                match self.left[class as usize] {
                    0 => return Some(class),
                    1 => {
                        let members = &self.colouring.classes[class as usize];
                        chosen.extend(members.iter().find(|&&member| self.reason[member as usize] == NONE));
                    }
                    _ => {}
                }
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clique::recolouring::Recolouring;
    use crate::clique::tests::{drawn, enumerate, rings};
    use proptest::prelude::*;

    fn bound(colouring: &Colouring, conflicts: &Lists) -> usize {
        colouring.classes.len() - Contradictions::of(colouring, conflicts).count
    }

    #[test]
    fn rings_of_odd_length_lose_a_colour_each() {
        let graph = rings();
        let conflicts = Lists::of_graph(&graph);
        let mut colouring = Colouring::new(graph.len());
        colouring.colour(Recolouring::of(&graph).order(), &conflicts);
        assert_eq!((colouring.classes.len(), bound(&colouring, &conflicts)), (15, 10));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]
        #[test]
        fn no_clique_has_more_vertices_than_contradictions_leave(
            vertices in 1_usize..=13,
            density in 0.3_f64..1.0,
            draws in proptest::collection::vec(0.0_f64..1.0, 78),
        ) {
            let graph = drawn(vertices, density, &draws);
            let conflicts = Lists::of_graph(&graph);
            let mut colouring = Colouring::new(vertices);
            colouring.colour(0..vertices, &conflicts);
            prop_assert!(bound(&colouring, &conflicts) >= enumerate(&graph));
        }
    }
}

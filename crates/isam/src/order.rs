//! A fill-reducing order of some of the variables, in which the subtrees that stay are elements from the start.
//!
//! Approximate minimum degree on the quotient graph (P. R. Amestoy, T. A. Davis, I. S. Duff, "An approximate minimum
//! degree ordering algorithm", SIAM J. Matrix Anal. Appl. 17, 1996), with supervariables, and with a group of variables
//! that come last, as in constrained COLAMD.

use crate::degrees::{Degrees, refill};

const NONE: usize = usize::MAX;

/// Variables that are eliminated together, and the variables that this connects.
#[derive(Debug, Default)]
pub(crate) struct Pivot {
    /// The variables eliminated, in order.
    pub(crate) variables: Vec<usize>,
    /// The remaining variables that are now all connected to each other.
    pub(crate) boundary: Vec<usize>,
    /// The absorbed elements. Numbers below the number of given elements are given elements, higher ones are pivots.
    pub(crate) children: Vec<usize>,
}

/// A quotient graph and the memory to eliminate it.
#[derive(Debug, Default)]
pub(crate) struct QuotientGraph {
    /// Neighbours by edges that no element covers.
    pub(crate) neighbours: Vec<Vec<usize>>,
    /// Elements at a variable.
    pub(crate) elements: Vec<Vec<usize>>,
    /// Principal variables of an element.
    boundaries: Vec<Vec<usize>>,
    /// Number of variables of an element, counting all members of supervariables.
    sizes: Vec<usize>,
    alive: Vec<bool>,
    /// Number of members of a supervariable; 0 for a variable that is a member of another one.
    pub(crate) weights: Vec<usize>,
    pub(crate) members: Vec<Vec<usize>>,
    pub(crate) degrees: Degrees,
    pub(crate) last: Vec<bool>,
    /// Whether only the variables that come last remain.
    late: bool,
    // A variable is marked if `mark` holds the current `stamp`.
    pub(crate) mark: Vec<usize>,
    pub(crate) stamp: usize,
    /// Per element: the number of its variables outside the pivot's boundary, and the pivot for which it was counted.
    outside: Vec<(usize, usize)>,
}

fn renew(lists: &mut Vec<Vec<usize>>, count: usize) {
    for list in lists.iter_mut() {
        list.clear();
    }
    if lists.len() < count {
        lists.resize_with(count, Vec::new);
    }
}

impl QuotientGraph {
    /// Resets the graph to so many variables and elements, without connections.
    pub(crate) fn clear(&mut self, variables: usize, elements: usize) {
        renew(&mut self.neighbours, variables);
        renew(&mut self.elements, variables);
        renew(&mut self.members, variables);
        renew(&mut self.boundaries, elements);
        refill(&mut self.weights, variables, 1);
        self.degrees.clear(variables);
        refill(&mut self.last, variables, false);
        refill(&mut self.mark, variables, 0);
        refill(&mut self.sizes, elements, 0);
        refill(&mut self.alive, elements, true);
        refill(&mut self.outside, elements, (0, NONE));
        self.stamp = 0;
        self.late = false;
    }

    /// Adds a neighbour to a variable's list. Call it once per direction; duplicates are allowed.
    pub(crate) fn connect(&mut self, variable: usize, neighbour: usize) {
        self.neighbours[variable].push(neighbour);
    }

    /// Adds a variable to a given element.
    pub(crate) fn include(&mut self, element: usize, variable: usize) {
        self.elements[variable].push(element);
        self.boundaries[element].push(variable);
        self.sizes[element] += 1;
    }

    /// Puts a variable into the group that comes last.
    pub(crate) fn put_last(&mut self, variable: usize) {
        self.last[variable] = true;
    }

    /// Eliminates everything.
    pub(crate) fn eliminate(&mut self) -> Vec<Pivot> {
        let variables = self.weights.len();
        let mut pivots = Vec::new();
        let mut remaining = variables;
        for variable in 0..variables {
            self.members[variable].push(variable);
            self.stamp += 1;
            let (stamp, mark) = (self.stamp, &mut self.mark);
            self.neighbours[variable].retain(|&other| std::mem::replace(&mut mark[other], stamp) != stamp);
            let covered: usize = self.elements[variable].iter().map(|&element| self.sizes[element] - 1).sum();
            self.degrees.of[variable] = (self.neighbours[variable].len() + covered).min(variables - 1);
        }
        for late in [false, true] {
            // In reverse, so that the oldest variable comes first among equal degrees.
            for variable in (0..variables).rev() {
                if self.last[variable] == late && self.weights[variable] > 0 {
                    self.degrees.insert(variable);
                }
            }
            self.late = late;
            while remaining > 0 {
                let Some(pivot) = self.degrees.least() else { break };
                if self.degrees.of[pivot] + self.weights[pivot] >= remaining {
                    // By their degrees, all remaining variables are connected to each other.
                    pivots.push(self.rest());
                    return pivots;
                }
                remaining -= self.weights[pivot];
                pivots.push(self.eliminate_pivot(pivot, remaining));
            }
        }
        pivots
    }

    /// One dense pivot of all remaining variables, those that come last at its end.
    fn rest(&mut self) -> Pivot {
        let mut pivot = Pivot::default();
        let principal: Vec<usize> =
            (0..self.weights.len()).filter(|&variable| self.weights[variable] > 0).collect();
        for late in [false, true] {
            for &variable in principal.iter().filter(|&&variable| self.last[variable] == late) {
                pivot.variables.append(&mut self.members[variable]);
                for &element in &self.elements[variable] {
                    if std::mem::replace(&mut self.alive[element], false) {
                        pivot.children.push(element);
                    }
                }
            }
        }
        pivot
    }

    fn eliminate_pivot(&mut self, pivot: usize, remaining: usize) -> Pivot {
        self.degrees.withdraw(pivot);
        self.weights[pivot] = 0;
        self.stamp += 1;
        let stamp = self.stamp;
        self.mark[pivot] = stamp;
        // The new element absorbs the pivot's elements: its boundary is the union of theirs and the pivot's neighbours.
        let mut boundary = Vec::new();
        let mut size = 0;
        let children = std::mem::take(&mut self.elements[pivot]);
        let direct = std::mem::take(&mut self.neighbours[pivot]);
        for list in std::iter::once(&direct).chain(children.iter().map(|&element| &self.boundaries[element]))
        {
            for &variable in list {
                if self.weights[variable] > 0 && self.mark[variable] != stamp {
                    self.mark[variable] = stamp;
                    size += self.weights[variable];
                    boundary.push(variable);
                }
            }
        }
        for &element in &children {
            self.alive[element] = false;
        }
        let structure =
            boundary.iter().flat_map(|&variable| self.members[variable].iter().copied()).collect();
        let element = self.sizes.len();
        self.sizes.push(size);
        self.alive.push(true);
        self.outside.push((0, NONE));
        for &variable in &boundary {
            self.degrees.withdraw(variable);
        }
        self.prune(element, &boundary);
        self.update_degrees(element, &boundary, size, remaining);
        self.merge_alike(&boundary);
        boundary.retain(|&variable| self.weights[variable] > 0);
        for &variable in &boundary {
            if self.last[variable] == self.late {
                self.degrees.insert(variable);
            }
        }
        if self.boundaries.len() <= element {
            self.boundaries.resize_with(element + 1, Vec::new);
        }
        self.boundaries[element] = boundary;
        Pivot { variables: std::mem::take(&mut self.members[pivot]), boundary: structure, children }
    }

    /// Removes from the lists of the boundary's variables what the new element covers.
    fn prune(&mut self, element: usize, boundary: &[usize]) {
        for &variable in boundary {
            let (mark, stamp, weights) = (&self.mark, self.stamp, &self.weights);
            self.neighbours[variable].retain(|&other| weights[other] > 0 && mark[other] != stamp);
            let alive = &self.alive;
            self.elements[variable].retain(|&other| alive[other]);
            for &other in &self.elements[variable] {
                // Counts the variables of `other` outside the new boundary, the set differences of equation (4.1).
                let (outside, pivot) = &mut self.outside[other];
                if *pivot != element {
                    (*outside, *pivot) = (self.sizes[other], element);
                }
                *outside -= self.weights[variable];
            }
            self.elements[variable].push(element);
        }
    }

    /// The approximate degrees of the boundary: Amestoy, Davis, Duff, equation (4.1).
    fn update_degrees(&mut self, element: usize, boundary: &[usize], size: usize, remaining: usize) {
        for &variable in boundary {
            let weight = self.weights[variable];
            let direct: usize = self.neighbours[variable].iter().map(|&other| self.weights[other]).sum();
            let covered: usize = self.elements[variable]
                .iter()
                .filter(|&&other| other != element)
                .map(|&other| self.outside[other].0)
                .sum();
            self.degrees.of[variable] = (direct + covered + size - weight)
                .min(self.degrees.of[variable] + size - weight)
                .min(remaining - weight);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eliminates by hand and compares every boundary with the pivot's.
    fn check(variables: usize, edges: &[(usize, usize)], elements: &[Vec<usize>], last: &[usize]) {
        let mut graph = QuotientGraph::default();
        // Twice, since the second run reuses the memory of the first.
        for _ in 0..2 {
            graph.clear(variables, elements.len());
            for &(a, b) in edges {
                graph.connect(a, b);
                graph.connect(b, a);
            }
            for (index, element) in elements.iter().enumerate() {
                for &variable in element {
                    graph.include(index, variable);
                }
            }
            for &variable in last {
                graph.put_last(variable);
            }
            let pivots = graph.eliminate();
            let mut filled = vec![vec![false; variables]; variables];
            let cover = elements
                .iter()
                .flat_map(|element| element.iter().flat_map(move |&a| element.iter().map(move |&b| (a, b))));
            for (a, b) in edges.iter().copied().chain(cover).filter(|(a, b)| a != b) {
                filled[a][b] = true;
                filled[b][a] = true;
            }
            let order: Vec<usize> = pivots.iter().flat_map(|pivot| pivot.variables.iter().copied()).collect();
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..variables).collect::<Vec<_>>());
            let mut parents = vec![0; elements.len() + pivots.len()];
            for (index, pivot) in pivots.iter().enumerate() {
                for &child in &pivot.children {
                    assert!(child < elements.len() + index);
                    parents[child] += 1;
                }
                let mut structure: Vec<usize> =
                    pivot.boundary.iter().chain(&pivot.variables).copied().collect();
                structure.sort_unstable();
                let mut found = pivot.variables.clone();
                for &variable in &pivot.variables {
                    let later: Vec<usize> = (0..variables).filter(|&other| filled[variable][other]).collect();
                    for &a in &later {
                        filled[a][variable] = false;
                        for &b in &later {
                            filled[a][b] = a != b;
                        }
                    }
                    filled[variable].fill(false);
                    found.extend(later);
                }
                found.sort_unstable();
                found.dedup();
                let is_last = index + 1 == pivots.len();
                assert!(found == structure || is_last, "pivot {index}: {found:?} {structure:?}");
            }
            assert!(parents.iter().all(|&count| count <= 1));
            let place = |variable: usize| order.iter().position(|&other| other == variable);
            for &late in last {
                for early in (0..variables).filter(|variable| !last.contains(variable)) {
                    assert!(place(early) < place(late), "{early} comes before {late}: {order:?}");
                }
            }
        }
    }

    #[test]
    fn boundaries_are_those_of_elimination() {
        check(1, &[], &[], &[]);
        check(5, &[], &[], &[4]);
        check(4, &[(0, 1), (1, 2), (2, 3)], &[], &[3]);
        check(6, &[(0, 1), (0, 1), (4, 5)], &[vec![0, 2, 3], vec![3], vec![], vec![1, 3, 5]], &[0, 5]);
        let mut state = 1_u64;
        let mut draw = |bound: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % bound
        };
        for _ in 0..300 {
            let variables = 2 + draw(30);
            let edges: Vec<_> = (0..draw(3 * variables))
                .map(|_| (draw(variables), draw(variables)))
                .filter(|(a, b)| a != b)
                .collect();
            let elements: Vec<Vec<usize>> = (0..draw(6))
                .map(|_| {
                    let share = 1 + draw(6);
                    (0..variables).filter(|_| draw(share + 1) == 0).collect()
                })
                .collect();
            let last: Vec<usize> = (0..variables).filter(|_| draw(5) == 0).collect();
            check(variables, &edges, &elements, &last);
        }
    }

    #[test]
    fn a_grid_is_ordered_with_little_fill() {
        let side = 20;
        let mut edges = Vec::new();
        for row in 0..side {
            for column in 0..side {
                let here = row * side + column;
                if column + 1 < side {
                    edges.push((here, here + 1));
                }
                if row + 1 < side {
                    edges.push((here, here + side));
                }
            }
        }
        let mut graph = QuotientGraph::default();
        graph.clear(side * side, 0);
        for &(a, b) in &edges {
            graph.connect(a, b);
            graph.connect(b, a);
        }
        let entries: usize = graph
            .eliminate()
            .iter()
            .map(|pivot| {
                let own = pivot.variables.len();
                own * (own + 1) / 2 + own * pivot.boundary.len()
            })
            .sum();
        // Row by row it is 8000; minimum degree gives about 3600.
        assert!(entries < 4500, "{entries}");
    }
}

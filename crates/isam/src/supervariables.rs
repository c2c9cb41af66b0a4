//! Supervariables of the quotient graph: indistinguishable variables that are eliminated together.

use crate::order::QuotientGraph;

impl QuotientGraph {
    /// Merges variables of the boundary with the same neighbours and elements: they stay indistinguishable for good.
    pub(crate) fn merge_alike(&mut self, boundary: &[usize]) {
        let mut keyed: Vec<(usize, usize)> = boundary
            .iter()
            .map(|&variable| {
                let sum = |list: &[usize]| list.iter().fold(0, |sum: usize, &entry| sum.wrapping_add(entry));
                let (neighbours, elements) = (&self.neighbours[variable], &self.elements[variable]);
                let key = sum(neighbours)
                    .wrapping_mul(31)
                    .wrapping_add(sum(elements))
                    .wrapping_mul(31)
                    .wrapping_add(
                        neighbours.len() * 1021 + elements.len() * 2 + usize::from(self.last[variable]),
                    );
                (key, variable)
            })
            .collect();
        keyed.sort_unstable();
        for first in 0..keyed.len() {
            let (key, variable) = keyed[first];
            if self.weights[variable] == 0 || keyed.get(first + 1).is_none_or(|next| next.0 != key) {
                continue;
            }
            self.stamp += 1;
            for &other in &self.neighbours[variable] {
                self.mark[other] = self.stamp;
            }
            for &(other_key, other) in &keyed[first + 1..] {
                if other_key != key {
                    break;
                }
                if self.weights[other] > 0 && self.is_alike(variable, other) {
                    let weight = std::mem::take(&mut self.weights[other]);
                    self.weights[variable] += weight;
                    self.degrees.of[variable] -= weight;
                    let mut members = std::mem::take(&mut self.members[other]);
                    self.members[variable].append(&mut members);
                    self.neighbours[other].clear();
                    self.elements[other].clear();
                }
            }
        }
    }

    /// Whether two variables have the same lists. The caller has marked the neighbours of the first one.
    fn is_alike(&self, variable: usize, other: usize) -> bool {
        self.last[variable] == self.last[other]
            && self.neighbours[variable].len() == self.neighbours[other].len()
            && self.neighbours[other].iter().all(|&neighbour| self.mark[neighbour] == self.stamp)
            // Elements are appended in the order in which they are made, and given ones are included by number. So equal sets
            // are equal lists.
            && self.elements[variable] == self.elements[other]
    }
}

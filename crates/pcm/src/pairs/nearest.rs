//! The nearest candidates by distance travelled.

use super::consistency::Pairs;
use crate::odometry::spread::Spatial;

/// Some candidates in a balanced k-d tree (Bentley, CACM 1975) over the distances travelled in both chains. The middle of a
/// slice divides the rest, alternately by one chain and by the other.
pub struct Nearest {
    tree: Vec<([f64; 2], usize)>,
}

impl Nearest {
    /// O(n log n).
    pub fn new<G: Spatial<DOF>, const DOF: usize>(pairs: &Pairs<'_, G, DOF>, members: &[usize]) -> Self {
        let mut tree: Vec<([f64; 2], usize)> =
            members.iter().map(|&member| (pairs.position(member), member)).collect();
        divide(&mut tree, 0);
        Self { tree }
    }

    /// Up to `count` members nearest to a position by the sum of both distances, without the candidate `but`. Nearest
    /// first, equal ones by number. O(count log n) for evenly spread members.
    pub fn of(&self, position: [f64; 2], but: usize, count: usize) -> Vec<usize> {
        let mut query = Query { position, but, count, found: Vec::with_capacity(count + 1) };
        query.search(&self.tree, 0, [0.0; 2]);
        query.found.into_iter().map(|(_, member)| member).collect()
    }
}

fn divide(entries: &mut [([f64; 2], usize)], axis: usize) {
    if entries.len() < 2 {
        return;
    }
    let middle = entries.len() / 2;
    let by_place = |one: &([f64; 2], usize), other: &([f64; 2], usize)| {
        one.0[axis].total_cmp(&other.0[axis]).then(one.1.cmp(&other.1))
    };
    let (before, _, after) = entries.select_nth_unstable_by(middle, by_place);
    divide(before, 1 - axis);
    divide(after, 1 - axis);
}

struct Query {
    position: [f64; 2],
    but: usize,
    count: usize,
    /// Distance and number, ascending.
    found: Vec<(f64, usize)>,
}

impl Query {
    /// `outside`: how far the position lies outside the region of these entries, in either chain.
    fn search(&mut self, entries: &[([f64; 2], usize)], axis: usize, outside: [f64; 2]) {
        let full = self.found.len() == self.count;
        if entries.is_empty()
            || full && self.found.last().is_some_and(|&(farthest, _)| outside[0] + outside[1] > farthest)
        {
            return;
        }
        let middle = entries.len() / 2;
        let (before, after) = (&entries[..middle], &entries[middle + 1..]);
        let offset = self.position[axis] - entries[middle].0[axis];
        let mut beyond = outside;
        beyond[axis] = offset.abs();
        let (near, far) = if offset < 0.0 { (before, after) } else { (after, before) };
        self.search(near, 1 - axis, outside);
        self.offer(entries[middle]);
        self.search(far, 1 - axis, beyond);
    }

    fn offer(&mut self, (place, member): ([f64; 2], usize)) {
        if member == self.but {
            return;
        }
        let distance = (place[0] - self.position[0]).abs() + (place[1] - self.position[1]).abs();
        let place = self.found.partition_point(|other| *other < (distance, member));
        if place < self.count {
            self.found.insert(place, (distance, member));
            self.found.truncate(self.count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use posecut_geometry::SE2;
    use proptest::prelude::*;

    use crate::generate::{Falsehood, Scenario};
    use crate::odometry::chain::Chains;
    use crate::pairs::candidate::group;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]
        #[test]
        fn the_tree_finds_what_a_search_through_all_finds(
            candidates in 1_usize..200,
            every in 1_usize..4,
            count in 1_usize..20,
            seed in 0_u64..1000,
        ) {
            // Positions are a metre apart and shared by several candidates, so that many distances are equal.
            let scenario = Scenario { candidates, outliers: 0.5, falsehood: Falsehood::Uniform, seed };
            let graph = scenario.draw::<SE2, 3>();
            let chains = Chains::<SE2, 3>::of(&graph).unwrap();
            let grouped = group(&graph, &chains).unwrap();
            let pairs = Pairs::new(&chains, &grouped.groups[0]);
            let members: Vec<usize> = (0..candidates).step_by(every).collect();
            let nearest = Nearest::new(&pairs, &members);
            for candidate in 0..candidates {
                let mut all: Vec<(f64, usize)> = members
                    .iter()
                    .filter(|&&member| member != candidate)
                    .map(|&member| (pairs.travelled(candidate, member), member))
                    .collect();
                all.sort_by(|one, other| one.partial_cmp(other).unwrap());
                let expected: Vec<usize> = all.into_iter().take(count).map(|(_, member)| member).collect();
                prop_assert_eq!(nearest.of(pairs.position(candidate), candidate, count), expected);
            }
        }
    }
}

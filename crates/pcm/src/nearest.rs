//! The nearest candidates by distance travelled.

use crate::consistency::Pairs;
use crate::spread::Spatial;

/// Some candidates, sorted by the distance travelled in one chain.
pub(crate) struct Nearest {
    weights: [f64; 2],
    /// The chain that they are sorted by: one whose distance counts.
    axis: usize,
    sorted: Vec<([f64; 2], usize)>,
}

impl Nearest {
    /// Distances travelled in chain A and in chain B count with these weights. O(n log n).
    pub(crate) fn new<G: Spatial<DOF>, const DOF: usize>(
        pairs: &Pairs<'_, G, DOF>,
        members: &[usize],
        weights: [f64; 2],
    ) -> Self {
        let axis = usize::from(weights[0] == 0.0);
        let mut sorted: Vec<([f64; 2], usize)> =
            members.iter().map(|&member| (pairs.position(member), member)).collect();
        sorted.sort_by(|one, other| one.0[axis].total_cmp(&other.0[axis]).then(one.1.cmp(&other.1)));
        Self { weights, axis, sorted }
    }

    /// Up to `count` members nearest to a position (the candidate `but` left out), nearest first, equal ones by number.
    /// Looks outwards from the position until the distance in one chain alone is too large.
    pub(crate) fn of(&self, position: [f64; 2], but: usize, count: usize) -> Vec<usize> {
        let axis = self.axis;
        let middle = self.sorted.partition_point(|entry| entry.0[axis] < position[axis]);
        let mut found: Vec<(f64, usize)> = Vec::with_capacity(count + 1);
        let mut offer = |&(place, member): &([f64; 2], usize)| {
            let along = self.weights[axis] * (place[axis] - position[axis]).abs();
            if found.len() == count && found.last().is_some_and(|&(farthest, _)| along > farthest) {
                return false;
            }
            let distance = self.weights[0] * (place[0] - position[0]).abs()
                + self.weights[1] * (place[1] - position[1]).abs();
            if member != but {
                let place = found.partition_point(|other| *other < (distance, member));
                if place < count {
                    found.insert(place, (distance, member));
                    found.truncate(count);
                }
            }
            true
        };
        // One look at either side, else equal distances on one side would hide the other.
        for entry in &self.sorted[middle..] {
            if !offer(entry) {
                break;
            }
        }
        for entry in self.sorted[..middle].iter().rev() {
            if !offer(entry) {
                break;
            }
        }
        found.into_iter().map(|(_, member)| member).collect()
    }
}

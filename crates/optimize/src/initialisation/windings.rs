//! Whether poses in the plane lie in the basin of rotations that the cycles of a graph point to.
//!
//! Around a cycle, the turns by which poses miss their measurements add up to the error of the cycle, except for a multiple of two pi
//! that depends on the poses. That multiple never changes as long as no single miss passes pi, so each choice of multiples is a basin of
//! its own. The most likely one has the smallest sums (L. Carlone, A. Censi, "From angular manifolds to the integer lattice: guaranteed
//! orientation estimation with application to pose graph optimization", 2014, section IV). In space, turns about different axes do not add
//! up, and there is no such test.

use std::f64::consts::FRAC_PI_2;

use posecut_geometry::SE2;

use crate::model::problem::Edge;

/// The largest sum that leaves no doubt: the next multiple is then at least three times as far away.
const LARGEST: f64 = FRAC_PI_2;

/// Whether the turns by which poses miss the edges add up to at most a quarter turn around every cycle that an edge closes with the edges
/// before it. Takes almost linear time.
pub(crate) fn is_unwound(edges: &[Edge<SE2, 3>], poses: &[SE2]) -> bool {
    let mut sums = Sums::new(poses.len());
    edges.iter().all(|edge| {
        let expected = poses[edge.from].rotation * edge.measurement.rotation;
        let miss = expected.inverse() * poses[edge.to].rotation;
        sums.join(edge.from, edge.to, miss.angle()).abs() <= LARGEST
    })
}

/// Trees of nodes, with the sum of turns from each node to the one above it.
struct Sums {
    above: Vec<(usize, f64)>,
}

impl Sums {
    fn new(nodes: usize) -> Self {
        Self { above: (0..nodes).map(|node| (node, 0.0)).collect() }
    }

    /// The root of a node's tree, and the sum from there. Halves the path.
    fn root(&mut self, mut node: usize) -> (usize, f64) {
        let mut sum = 0.0;
        loop {
            let (parent, turn) = self.above[node];
            let (grandparent, further) = self.above[parent];
            if parent == node {
                return (node, sum);
            }
            // A root is its own parent, at a turn of zero.
            self.above[node] = (grandparent, turn + further);
            sum += turn + further;
            node = grandparent;
        }
    }

    /// Adds an edge. Returns the sum around the cycle that it closes; zero if it joins two trees.
    fn join(&mut self, from: usize, to: usize, turn: f64) -> f64 {
        let ((root, before), (other, behind)) = (self.root(from), self.root(to));
        let sum = before + turn - behind;
        if root == other {
            return sum;
        }
        self.above[other] = (root, sum);
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::problem::EdgeKind;
    use nalgebra::Matrix3;
    use posecut_geometry::LieGroup;
    use proptest::prelude::*;
    use std::f64::consts::{PI, TAU};

    fn edge(from: usize, to: usize, turn: f64) -> Edge<SE2, 3> {
        Edge::new(from, to, SE2::new(1.0, 0.0, turn), Matrix3::identity(), EdgeKind::Odometry)
    }

    fn heading(turn: f64) -> SE2 {
        SE2::new(0.0, 0.0, turn)
    }

    /// A ring whose measurements turn once around, and poses that turn a number of times.
    fn ring(nodes: usize, times: f64, missing: f64) -> bool {
        let edges: Vec<_> =
            (0..nodes).map(|node| edge(node, (node + 1) % nodes, (TAU + missing) / nodes as f64)).collect();
        let poses: Vec<_> =
            (0..nodes).map(|node| heading(times * TAU * node as f64 / nodes as f64)).collect();
        is_unwound(&edges, &poses)
    }

    #[test]
    fn a_ring_that_turns_as_often_as_measured_passes() {
        assert!(ring(40, 1.0, 0.0) && ring(40, 1.0, 1.5) && ring(40, 1.0, -1.5));
        // Each edge misses by little, and these poses are a local minimum of their rotations.
        assert!(!ring(40, 0.0, 0.0) && !ring(40, 2.0, 0.0) && !ring(40, -1.0, 0.0));
        // The error of the cycle is too large to tell.
        assert!(!ring(40, 1.0, 1.6) && !ring(40, 1.0, -1.6));
    }

    proptest! {
        /// The sum around a cycle is what its turns add up to, in every order of the edges and from every side.
        #[test]
        fn sums_around_cycles(
            turns in prop::collection::vec(-PI..PI, 2..30),
            order in any::<prop::sample::Index>(),
            reversed in any::<u32>(),
        ) {
            let nodes = turns.len();
            let mut sums = Sums::new(nodes);
            let start = order.index(nodes);
            let mut last = 0.0;
            for place in (start..nodes).chain(0..start) {
                let (from, to, turn) = (place, (place + 1) % nodes, turns[place]);
                let is_last = (place + 1) % nodes == start;
                let backwards = reversed >> (place % 32) & 1 == 1;
                let sum = if backwards { sums.join(to, from, -turn) } else { sums.join(from, to, turn) };
                if is_last {
                    last = if backwards { -sum } else { sum };
                } else {
                    prop_assert_eq!(sum, 0.0);
                }
            }
            prop_assert!((last - turns.iter().sum::<f64>()).abs() < 1e-9, "{} {:?}", last, turns);
        }

        /// A common motion of all poses changes nothing, near pi neither.
        #[test]
        fn a_common_motion_changes_nothing(
            turns in prop::collection::vec(-PI..PI, 3..20),
            noise in prop::collection::vec(-0.3..0.3, 20),
            motion in -PI..PI,
        ) {
            let nodes = turns.len();
            let edges: Vec<_> = (0..nodes)
                .map(|node| {
                    let to = (node + 1) % nodes;
                    edge(node, to, turns[to] - turns[node] + noise[node])
                })
                .collect();
            let sum: f64 = noise[..nodes].iter().sum();
            prop_assume!((sum.abs() - LARGEST).abs() > 1e-9);
            let poses: Vec<_> = turns.iter().map(|turn| heading(*turn)).collect();
            let moved: Vec<_> = poses.iter().map(|pose| SE2::new(3.0, -2.0, motion).compose(pose)).collect();
            prop_assert_eq!(is_unwound(&edges, &poses), sum.abs() <= LARGEST);
            prop_assert_eq!(is_unwound(&edges, &moved), sum.abs() <= LARGEST);
        }
    }
}

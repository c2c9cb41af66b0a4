//! Sums of costs.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use faer::traits::pulp::{Simd, WithSimd};
use posecut_cholesky::instructions::for_small_blocks;
use posecut_geometry::LieGroup;
use posecut_geometry::lanes::WIDTH;

use super::lanes::LaneGroup;
use super::prior;
use super::problem::{Edge, Problem};
use super::residual::squared;
use super::term::Term;

/// The sum of `e^T Omega e` over edges and priors, without kernels.
pub fn chi_square<G: LieGroup<DOF>, const DOF: usize>(problem: &Problem<G, DOF>, poses: &[G]) -> f64 {
    let edges: f64 = problem.edges().iter().map(|edge| squared(edge, poses)).sum();
    problem.priors().iter().fold(edges, |sum, prior| sum + prior.squared(&poses[prior.node]))
}

/// The sum of `rho(e^T Omega e)` over edges and priors.
pub(crate) fn cost<G: LaneGroup<DOF>, const DOF: usize>(problem: &Problem<G, DOF>, poses: &[G]) -> f64 {
    let edges = total(problem.edges(), poses);
    if problem.priors().is_empty() { edges } else { edges + prior::cost(problem.priors(), poses) }
}

/// Whether edges cost more than `limit` by more than rounding errors. Stops at the first edges, from the last one on, that do: landmark
/// edges mostly come last, and a spanning tree leaves no other residuals.
pub(crate) fn exceeds<G: LaneGroup<DOF>, const DOF: usize>(
    edges: &[Edge<G, DOF>],
    poses: &[G],
    limit: f64,
) -> bool {
    // Far above the rounding error of a sum of 1e9 terms.
    let limit = limit * (1.0 + 1e-6);
    let mut sum = 0.0;
    edges.iter().rev().any(|edge| {
        sum += edge.cost(poses);
        sum > limit
    })
}

/// The sum of the costs of terms.
pub(crate) fn total<G: LieGroup<DOF>, T: Term<G, DOF>, const DOF: usize>(terms: &[T], poses: &[G]) -> f64 {
    // Uses vector instructions of the machine for everything that is inlined below.
    for_small_blocks(Total { terms, poses })
}

/// [`total`] for one set of vector instructions. Not a closure: a closure would not be inlined.
struct Total<'a, G, T, const DOF: usize> {
    terms: &'a [T],
    poses: &'a [G],
}

impl<G: LieGroup<DOF>, T: Term<G, DOF>, const DOF: usize> WithSimd for Total<'_, G, T, DOF> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let mut sum = 0.0;
        let mut costs = [0.0; WIDTH];
        for terms in self.terms.chunks(S::F64_LANES) {
            let costs = &mut costs[..terms.len()];
            if !T::costs(simd, terms, self.poses, costs) {
                for (term, cost) in terms.iter().zip(&mut *costs) {
                    *cost = term.cost(self.poses);
                }
            }
            for &mut cost in costs {
                sum += cost;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::problem::EdgeKind;
    use posecut_geometry::{LieGroup, SE2};

    #[test]
    fn a_cost_exceeds_limits_below_it_alone() {
        let poses: Vec<_> = (0..9).map(|node| SE2::new(f64::from(node), 0.0, 0.1)).collect();
        let edges: Vec<_> = (1..9)
            .map(|to| {
                Edge::new(to - 1, to, SE2::identity(), nalgebra::Matrix3::identity(), EdgeKind::Odometry)
            })
            .collect();
        let cost = total(&edges, &poses);
        assert!(exceeds(&edges, &poses, 0.9 * cost) && exceeds(&edges, &poses, 0.0));
        assert!(!exceeds(&edges, &poses, cost) && !exceeds(&edges, &poses, f64::NAN));
    }
}

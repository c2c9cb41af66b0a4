//! The Mahalanobis distance of a pair of candidates.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use nalgebra::{SMatrix, SVector};
use posecut_geometry::LieGroup;

use super::candidate::Candidate;
use crate::odometry::chain::{Chain, squared_mahalanobis};

/// The squared Mahalanobis distance from zero of Log(E), where E is the loop through candidates a = (i, k, `Z_a`) and b =
/// (j, l, `Z_b`) and the odometry between them:
///
/// E = `Z_a`^-1 (P_i^-1 P_j) `Z_b` (Q_l^-1 Q_k)            (Mangelson et al., equation 6)
///
/// The distance does not change when the loop is conjugated by Q_k. This gives Q_k E Q_k^-1 = T_a^-1 T_b for the alignments
/// T, with the covariance
///
/// Sigma = C_a + C_b + Ad(T_a^-1) dS_A Ad(T_a^-1)^T + dS_B.
///
/// A pair thus needs a single change of frame. Within one chain the two stretches of odometry may share steps: a shared
/// step enters once, through the sum of both its effects, each with its sign.
///
/// `None` if Sigma is not positive definite. O(1).
#[inline(always)]
pub fn squared_distance<G: LieGroup<DOF>, const DOF: usize>(
    chain_a: &Chain<G, DOF>,
    chain_b: &Chain<G, DOF>,
    same_chain: bool,
    a: &Candidate<G, DOF>,
    b: &Candidate<G, DOF>,
) -> Option<f64> {
    let (error, covariance) = loop_through(chain_a, chain_b, same_chain, a, b);
    squared_mahalanobis(&covariance, &error)
}

/// Log(E) and the lower triangle of Sigma of the loop through two candidates, conjugated as for [`squared_distance`]. O(1).
#[inline(always)]
pub(crate) fn loop_through<G: LieGroup<DOF>, const DOF: usize>(
    chain_a: &Chain<G, DOF>,
    chain_b: &Chain<G, DOF>,
    same_chain: bool,
    a: &Candidate<G, DOF>,
    b: &Candidate<G, DOF>,
) -> (SVector<f64, DOF>, SMatrix<f64, DOF, DOF>) {
    let mut covariance = a.covariance + b.covariance;
    add_odometry(&mut covariance, chain_a, chain_b, same_chain, a, b);
    (a.from_a.compose(&b.alignment).log(), covariance)
}

/// Adds the odometry's part of a pair's covariance, at least to the lower triangle.
#[inline(always)]
pub(crate) fn add_odometry<G: LieGroup<DOF>, const DOF: usize>(
    covariance: &mut SMatrix<f64, DOF, DOF>,
    chain_a: &Chain<G, DOF>,
    chain_b: &Chain<G, DOF>,
    same_chain: bool,
    a: &Candidate<G, DOF>,
    b: &Candidate<G, DOF>,
) {
    if same_chain && let Some(shared) = Shared::of(a, b) {
        let both = shared.effect(&a.to_b);
        let steps = chain_a.covariance_between(shared.first, shared.last);
        add_congruence(covariance, &both, &steps);
        let rest = chain_a.covariance_between(a.i, b.i) - steps;
        add_congruence(covariance, &a.to_b, &rest);
        *covariance += chain_b.covariance_between(a.k, b.k) - steps;
    } else {
        add_congruence(covariance, &a.to_b, &chain_a.covariance_between(a.i, b.i));
        *covariance += chain_b.covariance_between(a.k, b.k);
    }
}

/// The squared distance of the loop through one candidate of a chain and the odometry between its own ends, as for a pair.
/// The loop E = Z^-1 P_i^-1 P_k, conjugated by P_k, is the inverse of the alignment, with covariance C + S_k - S_i. O(1).
pub fn squared_distance_to_odometry<G: LieGroup<DOF>, const DOF: usize>(
    chain: &Chain<G, DOF>,
    candidate: &Candidate<G, DOF>,
) -> Option<f64> {
    let (error, covariance) = loop_through_odometry(chain, candidate);
    squared_mahalanobis(&covariance, &error)
}

/// Log(E) and its covariance for [`squared_distance_to_odometry`]. O(1).
pub(crate) fn loop_through_odometry<G: LieGroup<DOF>, const DOF: usize>(
    chain: &Chain<G, DOF>,
    candidate: &Candidate<G, DOF>,
) -> (SVector<f64, DOF>, SMatrix<f64, DOF, DOF>) {
    let covariance = candidate.covariance + chain.covariance_between(candidate.i, candidate.k);
    (candidate.from_a.log(), covariance)
}

/// Adds F S F^T to a sum, at least to its lower triangle, for an F whose block below the diagonal is zero, as in an
/// adjoint. Works by columns, so that the inner loops run along memory.
#[inline(always)]
fn add_congruence<const DOF: usize>(
    sum: &mut SMatrix<f64, DOF, DOF>,
    frame: &SMatrix<f64, DOF, DOF>,
    inner: &SMatrix<f64, DOF, DOF>,
) {
    let (frame, inner) = (&frame.data.0, &inner.data.0);
    // Translations come first: 2 of 3 axes, or 3 of 6; their columns of F are zero below.
    let translations = DOF.div_ceil(2);
    let mut carried = [[0.0; DOF]; DOF];
    for (carried, inner) in carried.iter_mut().zip(inner) {
        for term in 0..translations {
            for row in 0..translations {
                carried[row] += frame[term][row] * inner[term];
            }
        }
        for term in translations..DOF {
            for row in 0..DOF {
                carried[row] += frame[term][row] * inner[term];
            }
        }
    }
    for (column, sum) in sum.data.0.iter_mut().enumerate() {
        let first = if column < translations { 0 } else { translations };
        for term in first..DOF {
            for row in first..DOF {
                sum[row] += carried[term][row] * frame[term][column];
            }
        }
    }
}

/// The steps that both stretches of odometry, i to j and l to k, contain.
pub(crate) struct Shared {
    first: usize,
    last: usize,
    same_direction: bool,
}

impl Shared {
    #[inline(always)]
    pub(crate) fn of<G, const DOF: usize>(a: &Candidate<G, DOF>, b: &Candidate<G, DOF>) -> Option<Self> {
        let first = a.i.min(b.i).max(a.k.min(b.k));
        let last = a.i.max(b.i).min(a.k.max(b.k));
        // The first stretch runs from i to j, the second from l back to k.
        (first < last).then_some(Self { first, last, same_direction: (a.i < b.i) == (b.k < a.k) })
    }

    /// The error of a shared step acts through the stretch of A and through that of B at the same time.
    #[inline(always)]
    fn effect<const DOF: usize>(&self, to_b: &SMatrix<f64, DOF, DOF>) -> SMatrix<f64, DOF, DOF> {
        if self.same_direction { to_b + SMatrix::identity() } else { to_b - SMatrix::identity() }
    }
}

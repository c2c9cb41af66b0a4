//! Tests one candidate against blocks of others.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use nalgebra::SMatrix;
use pulp::Simd;

use super::Block;
use super::elimination::squared_mahalanobis;
use crate::odometry::chain::Chain;
use crate::odometry::spread::Spatial;
use crate::pairs::candidate::Candidate;
use crate::pairs::pretest::{Place, Turn};
use posecut_geometry::lanes::{Lanes, Wide};

/// One candidate, to be tested against blocks of others.
pub(crate) struct Row<'a, const DOF: usize> {
    pub(super) turn: &'a Turn,
    pub(super) place: &'a Place,
    /// The candidate's own spreads at its own position: as measured, along chain A, along chain B.
    pub(super) spreads: [f64; 3],
    /// i and k.
    pub(super) places: [f64; 2],
    pub(super) frame: &'a SMatrix<f64, DOF, DOF>,
    pub(super) landmark: &'a SMatrix<f64, DOF, DOF>,
    pub(super) chain_a: &'a SMatrix<f64, DOF, DOF>,
    pub(super) chain_b: &'a SMatrix<f64, DOF, DOF>,
    /// Whether chain A is chain B, so that stretches may share steps.
    pub(super) same_chain: bool,
}

/// The results for the lanes of a register, one bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Verdicts {
    /// Rejected by rotation.
    pub(crate) rotation: u64,
    /// Rejected by position.
    pub(crate) translation: u64,
    /// Squared Mahalanobis distances of the other lanes; NaN if the covariance is not positive definite.
    pub(crate) distances: Wide,
}
impl<'a, const DOF: usize> Row<'a, DOF> {
    pub(crate) fn new<G>(
        (turn, place): (&'a Turn, &'a Place),
        candidate: &'a Candidate<G, DOF>,
        (chain_a, chain_b): (&'a Chain<G, DOF>, &'a Chain<G, DOF>),
        same_chain: bool,
    ) -> Self {
        Self {
            turn,
            place,
            spreads: [place.own.at(&place.point), place.a.at(&place.claimed), place.b.at(&place.point)],
            places: place.steps.map(|step| step as f64),
            frame: &candidate.to_b,
            landmark: &candidate.covariance,
            chain_a: &chain_a.covariances[candidate.i],
            chain_b: &chain_b.covariances[candidate.k],
            same_chain,
        }
    }

    /// Tests the pairs with the lanes of a register in a block, only those in `asked`: the pre-test, and the squared
    /// distances of the pairs that it leaves open. `doubled` is that of the pre-test.
    #[inline(always)]
    pub(crate) fn test<G: Spatial<DOF>, S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        asked: u64,
        (gate, doubled): (f64, f64),
    ) -> Verdicts {
        let rotation = asked & self.turned_apart(simd, block, first, gate, doubled).bits();
        let mut verdicts = Verdicts { rotation, ..Verdicts::default() };
        let open = asked & !verdicts.rotation;
        if open == 0 {
            return verdicts;
        }
        verdicts.translation = open & self.shifted_apart(simd, block, first, gate, doubled).bits();
        let open = open & !verdicts.translation;
        if open == 0 {
            return verdicts;
        }
        let mut error = self.error::<G, S>(simd, block, first, open);
        let mut covariance = [[Lanes::splat(simd, 0.0); DOF]; DOF];
        self.covariance(simd, block, first, &mut covariance);
        if self.same_chain {
            self.add_shared(simd, block, first, open, &mut covariance);
        }
        squared_mahalanobis(simd, &mut covariance, &mut error).store(&mut verdicts.distances, 0);
        verdicts
    }
}

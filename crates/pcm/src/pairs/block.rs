//! Blocks of candidates, whose pairs with one other candidate are tested together.
//!
//! A [`Row`] is the one candidate, a [`Block`] eight others, one in each lane. `pretest` computes the bounds of the
//! pre-test, `error` the loop's error, `covariance` its covariance and `shared` the effect of shared steps on it.
//! `elimination` computes the squared distance from both.

mod covariance;
mod elimination;
mod error;
mod pretest;
mod row;
mod shared;
mod spread;

use super::candidate::Candidate;
use super::pretest::{Place, Turn};
use crate::odometry::chain::Chain;
use posecut_geometry::lanes::Wide;
pub(crate) use row::Row;
use spread::WideSpread;

/// Eight candidates. Of symmetric matrices only the lower triangle is used.
pub(crate) struct Block<const DOF: usize> {
    quaternion: [Wide; 4],
    /// Bounds on the rotation: own, and accumulated along chains A and B.
    turns: [Wide; 3],
    rotation: [[Wide; 3]; 3],
    translation: [Wide; 3],
    /// Spreads: own, and accumulated along chains A and B.
    spreads: [WideSpread; 3],
    /// i and k.
    places: [Wide; 2],
    landmark: [[Wide; DOF]; DOF],
    chain_a: [[Wide; DOF]; DOF],
    chain_b: [[Wide; DOF]; DOF],
}

impl<const DOF: usize> Default for Block<DOF> {
    fn default() -> Self {
        Self {
            quaternion: Default::default(),
            turns: Default::default(),
            rotation: Default::default(),
            translation: Default::default(),
            spreads: Default::default(),
            places: Default::default(),
            landmark: [[Wide::default(); DOF]; DOF],
            chain_a: [[Wide::default(); DOF]; DOF],
            chain_b: [[Wide::default(); DOF]; DOF],
        }
    }
}

impl<const DOF: usize> Block<DOF> {
    /// Puts a candidate into a lane.
    pub(crate) fn set<G>(
        &mut self,
        lane: usize,
        (turn, place): (&Turn, &Place),
        candidate: &Candidate<G, DOF>,
        (chain_a, chain_b): (&Chain<G, DOF>, &Chain<G, DOF>),
    ) {
        for (wide, value) in self.quaternion.iter_mut().zip(turn.quaternion) {
            wide.0[lane] = value;
        }
        for (wide, value) in self.turns.iter_mut().zip([turn.own, turn.a, turn.b]) {
            wide.0[lane] = value;
        }
        for (row, wide) in self.rotation.iter_mut().enumerate() {
            for (column, wide) in wide.iter_mut().enumerate() {
                wide.0[lane] = place.rotation[(row, column)];
            }
            self.translation[row].0[lane] = place.translation[row];
        }
        for (wide, spread) in self.spreads.iter_mut().zip([&place.own, &place.a, &place.b]) {
            wide.set(lane, spread);
        }
        for (wide, step) in self.places.iter_mut().zip(place.steps) {
            wide.0[lane] = step as f64;
        }
        let chains = [&chain_a.covariances[candidate.i], &chain_b.covariances[candidate.k]];
        for row in 0..DOF {
            for column in 0..=row {
                self.landmark[row][column].0[lane] = candidate.covariance[(row, column)];
                self.chain_a[row][column].0[lane] = chains[0][(row, column)];
                self.chain_b[row][column].0[lane] = chains[1][(row, column)];
            }
        }
    }
}

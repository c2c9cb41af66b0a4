//! Errors of loops through wrong neighbouring candidates.

use nalgebra::SMatrix;

use crate::model::{Model, Motion};
use crate::partners::Partners;

/// Ranks of the neighbours that loops are made with.
pub(crate) const RANKS: [usize; 4] = [0, 1, 3, 7];
/// The fewest loops that determine a second moment.
const LEAST: usize = 20;

/// Second moments of the errors of loops through a candidate between two chains and each of its neighbours, if both are
/// wrong; in the frame of the candidate's end in chain B. `None` where there are too few loops.
///
/// Wrong neighbours lead from near positions to near positions, and mostly claim that these are the same one. Their loops
/// have small errors, whatever the odometry is. If R, the second moment of two positions anywhere, is the only alternative, a
/// very uncertain odometry explains them best: with four wrong candidates of five, its variance was estimated a thousand
/// times too large.
pub(crate) struct Neighbours<const DOF: usize>([Option<SMatrix<f64, DOF, DOF>>; RANKS.len()]);

impl<const DOF: usize> Neighbours<DOF> {
    /// Estimates them from loops in which the neighbour gets the end in chain B of another neighbour. It stays near, but its
    /// measurement is meaningless there. O(candidates).
    pub(crate) fn of<G: Motion<DOF>>(
        model: &Model<G, DOF>,
        partners: &Partners,
        candidates: impl Iterator<Item = usize> + Clone,
    ) -> Self {
        let end = |closure: usize| model.closures[closure].candidate.k;
        let between = candidates.filter(|&closure| !model.same_chain(closure));
        Self(RANKS.map(|rank| {
            let errors = between.clone().filter_map(|closure| {
                let near = partners.near(closure);
                let other = *near.get(rank)?;
                let (before, after) = near.split_at(rank);
                let donor =
                    *after.iter().chain(before.iter().rev()).find(|&&donor| end(donor) != end(other))?;
                let error = model.pair_shuffled(closure, other, donor).error;
                Some(model.end(closure).inverse().adjoint() * error)
            });
            let (sum, count) = errors.fold((SMatrix::zeros(), 0), |(sum, count), error| {
                (sum + error * error.transpose(), count + 1)
            });
            (count >= LEAST).then(|| sum / count as f64)
        }))
    }

    /// Whether all of them are known.
    pub(crate) fn known(&self) -> bool {
        self.0.iter().all(Option::is_some)
    }

    /// The second moment for a candidate and its neighbour at an index of `RANKS`, in the frame of chain B.
    pub(crate) fn at<G: Motion<DOF>>(
        &self,
        model: &Model<G, DOF>,
        closure: usize,
        place: usize,
    ) -> Option<SMatrix<f64, DOF, DOF>> {
        let turned = model.end(closure).adjoint();
        self.0[place].map(|moment| turned * moment * turned.transpose())
    }
}

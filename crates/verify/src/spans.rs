//! Which steps of odometry the loops of accepted closures span.

use nalgebra::SMatrix;

use crate::model::Motion;
use crate::rounds::Rounds;

/// What accepted closures say about the steps of a chain. A step is named by the position that it leads to.
pub(crate) struct Spans<const DOF: usize> {
    /// Whether a loop spans the step to each position, and so would notice if it were broken.
    spanned: Vec<bool>,
    /// Prefix sums of the odometry's covariance over steps that no loop spans, in the chain's frame.
    open: Vec<SMatrix<f64, DOF, DOF>>,
    /// The first and the last position with an accepted closure to another chain. Loops through other chains span all between them.
    pub(crate) joined: Option<(usize, usize)>,
}

impl<const DOF: usize> Spans<DOF> {
    /// The spans of all chains. Takes O(positions + closures).
    pub(crate) fn of<G: Motion<DOF>>(rounds: &Rounds<'_, G, DOF>) -> Vec<Self> {
        let chains = &rounds.model.chains.chains;
        // How many more loops span the step to a position than the step before it.
        let mut changes: Vec<Vec<i64>> = chains.iter().map(|chain| vec![0; chain.poses.len() + 1]).collect();
        let mut joined: Vec<Option<(usize, usize)>> = vec![None; chains.len()];
        for closure in (0..rounds.accepted.len()).filter(|&closure| rounds.accepted[closure]) {
            let [(a, one), (b, other)] = rounds.model.ends(closure);
            if a == b {
                changes[a][one.min(other) + 1] += 1;
                changes[a][one.max(other) + 1] -= 1;
                continue;
            }
            for (chain, place) in [(a, one), (b, other)] {
                let (first, last) = joined[chain].unwrap_or((place, place));
                joined[chain] = Some((first.min(place), last.max(place)));
            }
        }
        let chains = chains.iter().zip(&rounds.random.odometry);
        chains
            .zip(changes.iter().zip(joined))
            .map(|((chain, factor), (changes, joined))| {
                let mut loops = 0;
                let spanned: Vec<bool> = (0..chain.poses.len())
                    .map(|place| {
                        loops += changes[place];
                        loops > 0 || joined.is_some_and(|(first, last)| first < place && place <= last)
                    })
                    .collect();
                let mut sum = SMatrix::zeros();
                let open = (0..spanned.len())
                    .map(|place| {
                        if place > 0 && !spanned[place] {
                            sum += chain.covariance_between(place - 1, place) * *factor;
                        }
                        sum
                    })
                    .collect();
                Self { spanned, open, joined }
            })
            .collect()
    }

    /// The steps that no loop spans.
    pub(crate) fn open_steps(&self) -> impl Iterator<Item = usize> + '_ {
        (1..self.spanned.len()).filter(|&later| !self.spanned[later])
    }

    /// The odometry's covariance over the open steps between two positions, in the chain's frame. Over the others, loops keep errors small.
    pub(crate) fn covariance_between(&self, one: usize, other: usize) -> SMatrix<f64, DOF, DOF> {
        self.open[one.max(other)] - self.open[one.min(other)]
    }
}

//! Loops of different lengths, and the same loops made false on purpose.

use nalgebra::{SMatrix, SVector};

use crate::odometry::chain::Chains;
use crate::odometry::spread::Spatial;
use crate::pairs::candidate::{Candidate, Group};
use crate::pairs::consistency::Pairs;
use crate::pairs::distance::add_odometry;
use crate::pairs::nearest::Nearest;

/// The number of candidates used, over all groups. More would not change the estimate.
const SAMPLE: usize = 1000;
/// The neighbours that each candidate is paired with, by rank. Near ones show the errors of the landmark edges, farther
/// ones those of the odometry.
const RANKS: [usize; 8] = [0, 1, 2, 3, 7, 15, 31, 63];
/// The share of the exchanged loops that a region must contain on each axis.
const HELD: f64 = 0.9;

/// The number of classes of similar loops: through pairs of near neighbours, through pairs of each farther rank, and
/// through one candidate and the odometry between its own ends.
pub(super) const CLASSES: usize = 6;
const ODOMETRY: usize = CLASSES - 1;

/// The class of a pair, by the index of its rank in [`RANKS`].
fn class_of(turn: usize) -> usize {
    turn.saturating_sub(RANKS.len() - ODOMETRY)
}

/// The error of a loop, and the two parts of its covariance.
#[derive(Clone, Debug)]
pub(super) struct Loop<const DOF: usize> {
    pub(super) class: usize,
    pub(super) error: SVector<f64, DOF>,
    pub(super) odometry: SMatrix<f64, DOF, DOF>,
    pub(super) landmark: SMatrix<f64, DOF, DOF>,
}

/// Loops, and for each class the logarithm of the volume that false loops fill.
#[derive(Clone, Debug)]
pub(super) struct Sample<const DOF: usize> {
    pub(super) loops: Vec<Loop<DOF>>,
    /// The same loops, but one end of a candidate is moved to the end of another candidate far away. They show what loops
    /// of false edges look like, even if all measurements are equal.
    pub(super) elsewhere: Vec<Loop<DOF>>,
    /// The number of candidates that the loops start from.
    pub(super) edges: usize,
    pub(super) log_volumes: [f64; CLASSES],
}

/// Loops of up to 1000 candidates, evenly spread over all groups.
pub(super) fn sample<G: Spatial<DOF>, const DOF: usize>(
    chains: &Chains<G, DOF>,
    groups: &[Group<G, DOF>],
) -> Sample<DOF> {
    let total: usize = groups.iter().map(|group| group.candidates.len()).sum();
    let step = total.div_ceil(SAMPLE).max(1);
    let mut loops = Vec::new();
    let mut elsewhere = Vec::new();
    let mut regions: [Vec<SVector<f64, DOF>>; CLASSES] = [const { Vec::new() }; CLASSES];
    let (mut before, mut edges) = (0, 0);
    for group in groups {
        let count = group.candidates.len();
        let pairs = Pairs::new(chains, group);
        let closing = Closing(&pairs);
        let all: Vec<usize> = (0..count).collect();
        let nearest = Nearest::new(&pairs, &all);
        for candidate in (0..count).filter(|candidate| (before + candidate).is_multiple_of(step)) {
            let neighbours = nearest.of(pairs.position(candidate), candidate, RANKS[7] + 1);
            let own = closing.odometry(candidate);
            edges += usize::from(own.is_some() || !neighbours.is_empty());
            let mut add = |closed: Loop<DOF>, error: G, shuffled: G| {
                regions[closed.class].push(closing.seen_at_place(candidate, &error));
                elsewhere.push(Loop { error: shuffled.log(), ..closed.clone() });
                loops.push(closed);
            };
            for (turn, &rank) in RANKS.iter().enumerate() {
                let Some(&other) = neighbours.get(rank) else { break };
                let donor = pairs.elsewhere(other, turn + 1);
                add(
                    closing.pair(candidate, other, class_of(turn)),
                    closing.pair_with(candidate, &closing.exchanged(other, donor)),
                    closing.pair_with(candidate, &closing.at_another_end(other, donor)),
                );
            }
            if let Some(own) = own {
                let donor = pairs.elsewhere(candidate, 1);
                add(
                    own,
                    closing.exchanged(candidate, donor).inverse(),
                    closing.at_another_end(candidate, donor).inverse(),
                );
            }
        }
        before += count;
    }
    let log_volumes = regions.map(|errors| log_volume(&errors));
    Sample { loops, elsewhere, edges, log_volumes }
}

/// The product, over the axes, of the range that contains nine tenths of the errors, divided by that share.
fn log_volume<const DOF: usize>(errors: &[SVector<f64, DOF>]) -> f64 {
    let Some(last) = errors.len().checked_sub(1) else { return 0.0 };
    let quantile = |sorted: &[f64], share: f64| sorted[(share * last as f64).round() as usize];
    (0..DOF)
        .map(|axis| {
            let mut values: Vec<f64> = errors.iter().map(|error| error[axis]).collect();
            values.sort_by(f64::total_cmp);
            let outside = 0.5 * (1.0 - HELD);
            let range = quantile(&values, 1.0 - outside) - quantile(&values, outside);
            (range.max(f64::MIN_POSITIVE) / HELD).ln()
        })
        .sum()
}

/// Closes loops of a group. Errors are those of [`crate::pairs::distance`], in the frame of chain B.
struct Closing<'a, G, const DOF: usize>(&'a Pairs<'a, G, DOF>);

impl<G: Spatial<DOF>, const DOF: usize> Closing<'_, G, DOF> {
    /// The loop through two candidates.
    fn pair(&self, one: usize, other: usize, class: usize) -> Loop<DOF> {
        let (a, b) = (&self.0.candidates[one], &self.0.candidates[other]);
        let mut odometry = SMatrix::zeros();
        add_odometry(&mut odometry, self.0.chain_a, self.0.chain_b, self.0.same_chain, a, b);
        odometry.fill_upper_triangle_with_lower_triangle();
        let error = a.from_a.compose(&b.alignment).log();
        Loop { class, error, odometry, landmark: a.covariance + b.covariance }
    }

    /// The loop through one candidate and the odometry. Between two chains there is none.
    fn odometry(&self, one: usize) -> Option<Loop<DOF>> {
        let candidate = &self.0.candidates[one];
        self.0.same_chain.then(|| Loop {
            class: ODOMETRY,
            error: candidate.from_a.log(),
            odometry: self.0.chain_a.covariance_between(candidate.i, candidate.k),
            landmark: candidate.covariance,
        })
    }

    /// The alignment of a candidate if it had the measurement of another.
    fn exchanged(&self, candidate: usize, donor: usize) -> G {
        let (candidate, donor) = (&self.0.candidates[candidate], &self.0.candidates[donor]);
        let poses = |of: &Candidate<G, DOF>| (self.0.chain_a.poses[of.i], self.0.chain_b.poses[of.k]);
        let ((donor_a, donor_b), (pose_a, pose_b)) = (poses(donor), poses(candidate));
        let measurement = donor_a.inverse().compose(&donor.alignment).compose(&donor_b);
        pose_a.compose(&measurement).compose(&pose_b.inverse())
    }

    /// The alignment of a candidate if it ended where another does: T Q_k Q_l^-1.
    fn at_another_end(&self, candidate: usize, donor: usize) -> G {
        let (candidate, donor) = (&self.0.candidates[candidate], &self.0.candidates[donor]);
        let (own, other) = (self.0.chain_b.poses[candidate.k], self.0.chain_b.poses[donor.k]);
        candidate.alignment.compose(&own).compose(&other.inverse())
    }

    /// The error of a pair if the second candidate had this alignment.
    fn pair_with(&self, one: usize, alignment: &G) -> G {
        self.0.candidates[one].from_a.compose(alignment)
    }

    /// The error in the frame of the candidate's end. Far from the origin of the chain a small rotation moves much; at the
    /// end itself, errors fill a compact region, whose volume is the same in any frame.
    fn seen_at_place(&self, candidate: usize, error: &G) -> SVector<f64, DOF> {
        let place = self.0.chain_b.poses[self.0.candidates[candidate].k];
        place.inverse().compose(error).compose(&place).log()
    }
}

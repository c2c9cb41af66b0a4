//! A cheap test that most inconsistent pairs fail and every consistent pair passes.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]

use nalgebra::{Matrix3, Vector3};

use super::candidate::Group;
use crate::odometry::chain::Chains;
use crate::odometry::spread::{Spatial, Spread, largest_turn};

/// A factor on the bounds, so that rounding never rejects a consistent pair.
pub(crate) const SLACK: f64 = 1.0 + 1e-6;

/// The result of the pre-test of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The rotations disagree by more than any covariance within the bounds allows.
    Rotation,
    /// The positions disagree by more than any covariance within the bounds allows.
    Translation,
    /// The full test must decide.
    Open,
}

/// Bounds for a group of candidates.
///
/// A marginal of a Gaussian error has at most the squared Mahalanobis distance of the whole, and x^T S^-1 x is at least
/// |x|^2 / (largest eigenvalue of S). A pair is therefore inconsistent in either of these cases:
///
/// - 4 sin^2(angle / 2) > gate * (bound on the rotation's largest eigenvalue). This takes one product of quaternions.
/// - |t|^2 > gate * (trace of the translation's covariance), in the frame of position k of the first candidate in chain B.
///   The two candidates give this position two values, which are |t| apart. The logarithm's translation is no shorter than
///   t, because the left Jacobian of a rotation lengthens nothing.
///
/// Within one chain, steps that both stretches share may count up to four times instead of twice: the odometry's part of
/// both bounds is doubled.
pub struct PreTest {
    pub(crate) turns: Vec<Turn>,
    pub(crate) places: Vec<Place>,
    pub(crate) doubled: f64,
}

/// The data of the rotation test.
pub(crate) struct Turn {
    pub(crate) quaternion: [f64; 4],
    pub(crate) own: f64,
    pub(crate) a: f64,
    pub(crate) b: f64,
}

/// The data of the position test.
pub(crate) struct Place {
    pub(crate) rotation: Matrix3<f64>,
    pub(crate) translation: Vector3<f64>,
    /// Position k in the frame of chain B.
    pub(crate) point: Vector3<f64>,
    /// The same position in the frame of chain A, according to the candidate.
    pub(crate) claimed: Vector3<f64>,
    pub(crate) own: Spread,
    pub(crate) a: Spread,
    pub(crate) b: Spread,
    /// i and k.
    pub(crate) steps: [usize; 2],
}

impl PreTest {
    /// O(1) a candidate, after O(1) a node of both chains.
    pub fn new<G: Spatial<DOF>, const DOF: usize>(chains: &Chains<G, DOF>, group: &Group<G, DOF>) -> Self {
        let (chain_a, chain_b) = (&chains.chains[group.a], &chains.chains[group.b]);
        let accumulated = |chain: &crate::odometry::chain::Chain<G, DOF>| -> Vec<f64> {
            let mut turn = 0.0;
            let mut turns = vec![0.0];
            for pair in chain.covariances.windows(2) {
                turn += largest_turn::<G, DOF>(&(pair[1] - pair[0])).max(0.0);
                turns.push(turn);
            }
            turns
        };
        let (turns_a, turns_b) = (accumulated(chain_a), accumulated(chain_b));
        let spread = |chain: &crate::odometry::chain::Chain<G, DOF>, place: usize, turns: &[f64]| {
            Spread::of::<G, DOF>(&chain.covariances[place], turns[place])
        };
        let mut turns = Vec::with_capacity(group.candidates.len());
        let mut places = Vec::with_capacity(group.candidates.len());
        for candidate in &group.candidates {
            let alignment = candidate.alignment.spatial();
            let own = Spread::of::<G, DOF>(
                &candidate.covariance,
                largest_turn::<G, DOF>(&candidate.covariance).max(0.0),
            );
            let a = spread(chain_a, candidate.i, &turns_a);
            let b = spread(chain_b, candidate.k, &turns_b);
            let q = alignment.rotation.quaternion();
            turns.push(Turn { quaternion: [q.w, q.i, q.j, q.k], own: own.turn, a: a.turn, b: b.turn });
            let rotation = alignment.rotation.to_rotation_matrix().into_inner();
            let point = chain_b.poses[candidate.k].spatial().translation;
            places.push(Place {
                rotation,
                translation: alignment.translation,
                point,
                claimed: rotation * point + alignment.translation,
                own,
                a,
                b,
                steps: [candidate.i, candidate.k],
            });
        }
        Self { turns, places, doubled: if group.a == group.b { 2.0 } else { 1.0 } }
    }

    /// 4 sin^2 of half the angle between the alignments, which is at most the angle's square.
    #[inline(always)]
    pub(crate) fn squared_turn(&self, one: usize, other: usize) -> f64 {
        let ([w, x, y, z], [ow, ox, oy, oz]) = (self.turns[one].quaternion, self.turns[other].quaternion);
        let half_cosine = w * ow + x * ox + y * oy + z * oz;
        4.0 * (1.0 - half_cosine * half_cosine)
    }

    /// The squared distance between the two positions that the candidates give to the first one's end in chain B.
    #[inline(always)]
    pub(crate) fn squared_shift(&self, one: usize, other: usize) -> f64 {
        let (a, b) = (&self.places[one], &self.places[other]);
        (b.rotation * a.point + b.translation - a.claimed).norm_squared()
    }

    /// The number of steps of the loop through both candidates: the odometry's and the two landmark edges.
    #[inline(always)]
    pub(crate) fn steps(&self, one: usize, other: usize) -> usize {
        let (a, b) = (&self.places[one].steps, &self.places[other].steps);
        a[0].abs_diff(b[0]) + a[1].abs_diff(b[1]) + 2
    }

    /// Whether a pair can pass a gate on the squared Mahalanobis distance. O(1).
    #[inline(always)]
    pub fn verdict(&self, one: usize, other: usize, gate: f64) -> Verdict {
        let (a, b) = (&self.turns[one], &self.turns[other]);
        let turn = a.own + b.own + self.doubled * ((a.a - b.a).abs() + (a.b - b.b).abs());
        if self.squared_turn(one, other) > gate * turn * SLACK {
            return Verdict::Rotation;
        }
        let (a, b) = (&self.places[one], &self.places[other]);
        let stretches =
            (a.a.at(&a.claimed) - b.a.at(&a.claimed)).abs() + (a.b.at(&a.point) - b.b.at(&a.point)).abs();
        let trace = a.own.at(&a.point) + b.own.at(&a.point) + self.doubled * stretches;
        if self.squared_shift(one, other) > gate * trace * SLACK {
            return Verdict::Translation;
        }
        Verdict::Open
    }
}

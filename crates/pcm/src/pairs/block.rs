//! Candidates in blocks, whose pairs with one other candidate are tested together.

#![allow(clippy::inline_always, reason = "what is not inlined into the dispatched loop is compiled for SSE2")]
#![allow(
    clippy::needless_range_loop,
    reason = "formulas over rows, columns and terms of several matrices at once"
)]

use nalgebra::{SMatrix, Vector3};
use pulp::Simd;

use super::candidate::Candidate;
use super::lanes::{Lanes, Mask, Wide};
use super::logarithm::logarithm;
use super::pretest::{Place, SLACK, Turn};
use crate::odometry::chain::Chain;
use crate::odometry::spread::{Spatial, Spread};

/// Eight candidates; of symmetric matrices the lower triangle is read.
pub(crate) struct Block<const DOF: usize> {
    quaternion: [Wide; 4],
    /// Bounds on the turn: own, and accumulated along chains A and B.
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

#[derive(Clone, Copy, Default)]
struct WideSpread {
    translation: Wide,
    lever: [Wide; 3],
    rotation: [Wide; 6],
}

impl WideSpread {
    fn set(&mut self, lane: usize, spread: &Spread) {
        self.translation.0[lane] = spread.translation;
        for (wide, value) in self.lever.iter_mut().zip(spread.lever) {
            wide.0[lane] = value;
        }
        for (wide, value) in self.rotation.iter_mut().zip(spread.rotation) {
            wide.0[lane] = value;
        }
    }

    /// As [`Spread::at`].
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, first: usize, q: &Vector3<f64>) -> Lanes<S> {
        let load = |wide: &Wide| Lanes::load(simd, wide, first);
        let [xx, yy, zz, xy, xz, yz] = &self.rotation;
        let lever = Lanes::load_three(simd, &self.lever, first);
        load(&self.translation)
            + (lever[0] * q.x + lever[1] * q.y + lever[2] * q.z) * 2.0
            + (load(xx) * q.x + (load(xy) * q.y + load(xz) * q.z) * 2.0) * q.x
            + (load(yy) * q.y + load(yz) * (2.0 * q.z)) * q.y
            + load(zz) * (q.z * q.z)
    }
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

/// One candidate, to be held against blocks of others.
pub(crate) struct Row<'a, const DOF: usize> {
    turn: &'a Turn,
    place: &'a Place,
    /// The candidate's own spreads at its own place: as measured, along chain A, along chain B.
    spreads: [f64; 3],
    /// i and k.
    places: [f64; 2],
    frame: &'a SMatrix<f64, DOF, DOF>,
    landmark: &'a SMatrix<f64, DOF, DOF>,
    chain_a: &'a SMatrix<f64, DOF, DOF>,
    chain_b: &'a SMatrix<f64, DOF, DOF>,
    /// Whether chain A is chain B, so that stretches may share steps.
    same_chain: bool,
}

/// What became of the lanes of a register, a bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Verdicts {
    /// Rejected by rotation.
    pub(crate) rotation: u64,
    /// Rejected by position.
    pub(crate) translation: u64,
    /// Squared Mahalanobis distances of the rest; NaN where the covariance is not positive definite.
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

    /// Tests the pairs with a register's lanes of a block, those in `asked` alone: the pre-test, and the squared distances
    /// of those that it leaves open. `doubled` as for the pre-test.
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

    /// As the pre-test of rotations.
    #[inline(always)]
    fn turned_apart<S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        gate: f64,
        doubled: f64,
    ) -> Mask<S> {
        let splat = |value: f64| Lanes::splat(simd, value);
        let [w, x, y, z] = Lanes::load_four(simd, &block.quaternion, first);
        let q = self.turn.quaternion;
        let half_cosine = w * q[0] + x * q[1] + y * q[2] + z * q[3];
        let turned = (splat(1.0) - half_cosine * half_cosine) * 4.0;
        let [own, a, b] = Lanes::load_three(simd, &block.turns, first);
        let stretches = (a - splat(self.turn.a)).abs() + (b - splat(self.turn.b)).abs();
        let bound = own + splat(self.turn.own) + stretches * doubled;
        (bound * (gate * SLACK)).less_than(turned)
    }

    /// As the pre-test of positions.
    #[inline(always)]
    fn shifted_apart<S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        gate: f64,
        doubled: f64,
    ) -> Mask<S> {
        let splat = |value: f64| Lanes::splat(simd, value);
        let (point, claimed) = (&self.place.point, &self.place.claimed);
        let mut shifted = splat(0.0);
        for axis in 0..3 {
            let [x, y, z] = Lanes::load_three(simd, &block.rotation[axis], first);
            let there = x * point.x + y * point.y + z * point.z;
            let shift = there + Lanes::load(simd, &block.translation[axis], first) - splat(claimed[axis]);
            shifted = shifted + shift * shift;
        }
        let [own, a, b] = self.spreads;
        let stretches = (block.spreads[1].at(simd, first, claimed) - splat(a)).abs()
            + (block.spreads[2].at(simd, first, point) - splat(b)).abs();
        let bound = block.spreads[0].at(simd, first, point) + splat(own) + stretches * doubled;
        (bound * (gate * SLACK)).less_than(shifted)
    }

    /// Log(T_a^-1 T_b).
    #[inline(always)]
    fn error<G: Spatial<DOF>, S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        asked: u64,
    ) -> [Lanes<S>; DOF] {
        let [w, x, y, z] = Lanes::load_four(simd, &block.quaternion, first);
        let [ow, ox, oy, oz] = self.turn.quaternion;
        // The conjugate of the row's quaternion times the block's.
        let quaternion = [
            w * ow + x * ox + y * oy + z * oz,
            x * ow - w * ox - z * oy + y * oz,
            y * ow + z * ox - w * oy - x * oz,
            z * ow - y * ox + x * oy - w * oz,
        ];
        let mut apart = Lanes::load_three(simd, &block.translation, first);
        for (axis, apart) in apart.iter_mut().enumerate() {
            *apart = *apart - Lanes::splat(simd, self.place.translation[axis]);
        }
        let rotation = &self.place.rotation;
        let mut translation = apart;
        for (axis, term) in translation.iter_mut().enumerate() {
            *term = apart[0] * rotation[(0, axis)]
                + apart[1] * rotation[(1, axis)]
                + apart[2] * rotation[(2, axis)];
        }
        let (straight, turned) = logarithm(simd, translation, quaternion, asked);
        let whole = [straight[0], straight[1], straight[2], turned[0], turned[1], turned[2]];
        let mut error = [whole[0]; DOF];
        for (term, axis) in error.iter_mut().zip(G::AXES) {
            *term = whole[axis];
        }
        error
    }

    /// The covariance of a stretch is that of the later end minus that of the earlier: 1 where the block's is the later.
    #[inline(always)]
    fn sign<S: Simd>(&self, simd: S, block: &Block<DOF>, first: usize, chain: usize) -> Lanes<S> {
        let one = Lanes::splat(simd, 1.0);
        let there = Lanes::load(simd, &block.places[chain], first);
        there.less_than(Lanes::splat(simd, self.places[chain])).select(-one, one)
    }

    /// What steps that both stretches share add to their covariance. Each acts through T + I where both run the same way and
    /// through T - I where they do not, T = Ad(T_a^-1); with S the covariance of the shared steps,
    ///
    /// (T +- I) S (T +- I)^T - T S T^T - S = +- (T S + S T^T).
    #[inline(always)]
    fn add_shared<S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        asked: u64,
        sum: &mut [[Lanes<S>; DOF]; DOF],
    ) {
        let load = |wide: &Wide| Lanes::load(simd, wide, first);
        let splat = |value: f64| Lanes::splat(simd, value);
        let (zero, one) = (splat(0.0), splat(1.0));
        let (here_i, here_k) = (splat(self.places[0]), splat(self.places[1]));
        let (there_i, there_k) = (load(&block.places[0]), load(&block.places[1]));
        // The ends of both stretches in the order of the chain, and the steps from the later start to the earlier end.
        let (back_i, back_k) = (there_i.less_than(here_i), there_k.less_than(here_k));
        let (start_i, end_i) = (back_i.select(there_i, here_i), back_i.select(here_i, there_i));
        let (start_k, end_k) = (back_k.select(there_k, here_k), back_k.select(here_k, there_k));
        let (starts_with_k, ends_with_i) = (start_i.less_than(start_k), end_i.less_than(end_k));
        let start = starts_with_k.select(start_k, start_i);
        let shared = start.less_than(ends_with_i.select(end_i, end_k));
        if shared.bits() & asked == 0 {
            return;
        }
        // The first stretch runs from i to j, the second from l back to k.
        let same_way = here_i.less_than(there_i).select(back_k.select(one, -one), back_k.select(-one, one));
        let sign = shared.select(same_way, zero);
        let mut steps = [[zero; DOF]; DOF];
        for row in 0..DOF {
            for column in 0..=row {
                let (own_i, own_k) = (splat(self.chain_a[(row, column)]), splat(self.chain_b[(row, column)]));
                let (other_i, other_k) =
                    (load(&block.chain_a[row][column]), load(&block.chain_b[row][column]));
                let at_start =
                    starts_with_k.select(back_k.select(other_k, own_k), back_i.select(other_i, own_i));
                let at_end = ends_with_i.select(back_i.select(own_i, other_i), back_k.select(own_k, other_k));
                let entry = (at_end - at_start) * sign;
                steps[row][column] = entry;
                steps[column][row] = entry;
            }
        }
        let translations = DOF.div_ceil(2);
        for row in 0..DOF {
            for column in 0..DOF {
                // An entry of T S; an adjoint is zero below its translations.
                let mut entry = steps[translations][column] * self.frame[(row, translations)];
                for term in translations + 1..DOF {
                    entry = entry + steps[term][column] * self.frame[(row, term)];
                }
                if row < translations {
                    for term in 0..translations {
                        entry = entry + steps[term][column] * self.frame[(row, term)];
                    }
                }
                let (low, high) = (row.max(column), row.min(column));
                let twice = if row == column { entry + entry } else { entry };
                sum[low][high] = sum[low][high] + twice;
            }
        }
    }

    /// C_a + C_b + Ad(T_a^-1) dS_A Ad(T_a^-1)^T + dS_B, the lower triangle: stretches that share no step.
    #[inline(always)]
    fn covariance<S: Simd>(
        &self,
        simd: S,
        block: &Block<DOF>,
        first: usize,
        sum: &mut [[Lanes<S>; DOF]; DOF],
    ) {
        let load = |wide: &Wide| Lanes::load(simd, wide, first);
        let splat = |value: f64| Lanes::splat(simd, value);
        let (sign_a, sign_b) = (self.sign(simd, block, first, 0), self.sign(simd, block, first, 1));
        // Translations come first: 2 of 3 axes, or 3 of 6. An adjoint is zero below them. Sums are kept in registers.
        let translations = DOF.div_ceil(2);
        let mut carried = [[sign_a; DOF]; DOF];
        for (column, carried) in carried.iter_mut().enumerate() {
            let mut stretch = [sign_a; DOF];
            for (row, stretch) in stretch.iter_mut().enumerate() {
                let (row, column) = (row.max(column), row.min(column));
                *stretch = (load(&block.chain_a[row][column]) - splat(self.chain_a[(row, column)])) * sign_a;
            }
            for (row, carried) in carried.iter_mut().enumerate() {
                let mut entry = stretch[translations] * self.frame[(row, translations)];
                for term in translations + 1..DOF {
                    entry = entry + stretch[term] * self.frame[(row, term)];
                }
                if row < translations {
                    for term in 0..translations {
                        entry = entry + stretch[term] * self.frame[(row, term)];
                    }
                }
                *carried = entry;
            }
        }
        for (row, sum) in sum.iter_mut().enumerate() {
            for (column, sum) in sum.iter_mut().enumerate().take(row + 1) {
                let stretch =
                    (load(&block.chain_b[row][column]) - splat(self.chain_b[(row, column)])) * sign_b;
                let own = load(&block.landmark[row][column]) + splat(self.landmark[(row, column)]);
                let mut entry = own + stretch;
                for term in translations..DOF {
                    entry = entry + carried[term][row] * self.frame[(column, term)];
                }
                if column < translations {
                    for term in 0..translations {
                        entry = entry + carried[term][row] * self.frame[(column, term)];
                    }
                }
                *sum = entry;
            }
        }
    }
}

/// As [`crate::odometry::chain::squared_mahalanobis`]; NaN where the covariance is not positive definite.
#[inline(always)]
fn squared_mahalanobis<S: Simd, const DOF: usize>(
    simd: S,
    covariance: &mut [[Lanes<S>; DOF]; DOF],
    error: &mut [Lanes<S>; DOF],
) -> Lanes<S> {
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let mut definite = zero.less_than(covariance[0][0]);
    let mut sum = zero;
    for column in 0..DOF {
        let pivot = covariance[column][column];
        definite = definite.and(zero.less_than(pivot));
        let inverse = one / pivot;
        sum = sum + error[column] * error[column] * inverse;
        for later in column + 1..DOF {
            let ratio = covariance[later][column] * inverse;
            error[later] = error[later] - ratio * error[column];
            for last in later..DOF {
                covariance[last][later] = covariance[last][later] - ratio * covariance[last][column];
            }
        }
    }
    definite.select(sum, Lanes::splat(simd, f64::NAN))
}

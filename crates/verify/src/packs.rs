//! Loops stored side by side, component by component, so that a vector instruction processes several of them.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]
#![allow(clippy::needless_range_loop, reason = "several arrays go by the same component and lane")]

use nalgebra::SMatrix;
use posecut_geometry::lanes::{Lanes, WIDTH, Wide};
use pulp::{Arch, Simd, WithSimd};

use crate::calibration::Calibration;
use crate::likelihoods::Likelihoods;
use crate::model::Loop;

/// The lower triangle of a symmetric matrix of each loop.
type Stored<const DOF: usize> = [[Wide; DOF]; DOF];
/// The same in registers.
type Symmetric<S, const DOF: usize> = [[Lanes<S>; DOF]; DOF];

/// Loops to evaluate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Sample<const DOF: usize> {
    loops: Vec<Loop<DOF>>,
    packs: Vec<Pack<DOF>>,
}

/// Up to eight loops. Unused lanes have covariances of zero, so that they give no likelihood.
#[derive(Clone, Debug)]
struct Pack<const DOF: usize> {
    error: [Wide; DOF],
    landmark: Stored<DOF>,
    translation: Stored<DOF>,
    apart: Stored<DOF>,
    beside: Stored<DOF>,
    sides: [Side<DOF>; 2],
}

/// The covariances that the odometry of one chain adds to each loop.
#[derive(Clone, Copy, Debug)]
struct Side<const DOF: usize> {
    chains: [usize; WIDTH],
    random: Stored<DOF>,
    coherent: Stored<DOF>,
}

impl<const DOF: usize> Sample<DOF> {
    pub(crate) fn is_empty(&self) -> bool {
        self.loops.is_empty()
    }

    pub(crate) fn len(&self) -> usize {
        self.loops.len()
    }

    pub(crate) fn push(&mut self, closed: Loop<DOF>) {
        let lane = self.loops.len() % WIDTH;
        if lane == 0 {
            self.packs.push(Pack::empty());
        }
        if let Some(pack) = self.packs.last_mut() {
            pack.set(lane, &closed);
        }
        self.loops.push(closed);
    }

    pub(crate) fn loops(&self) -> &[Loop<DOF>] {
        &self.loops
    }

    /// Likelihoods of every `step`-th pack under these factors. O(loops DOF^3 / step).
    pub(crate) fn likelihoods(&self, factors: &Calibration, shifted: bool, step: usize) -> Vec<Likelihoods> {
        Arch::new().dispatch(Compare { packs: &self.packs, factors, shifted, step })
    }
}

impl<const DOF: usize> Pack<DOF> {
    fn empty() -> Self {
        let zero = [[Wide::default(); DOF]; DOF];
        let side = Side { chains: [0; WIDTH], random: zero, coherent: zero };
        Self {
            error: [Wide::default(); DOF],
            landmark: zero,
            translation: zero,
            apart: zero,
            beside: zero,
            sides: [side; 2],
        }
    }

    fn set(&mut self, lane: usize, closed: &Loop<DOF>) {
        let put = |to: &mut Stored<DOF>, from: &SMatrix<f64, DOF, DOF>| {
            for row in 0..DOF {
                for column in 0..=row {
                    to[row][column].0[lane] = from[(row, column)];
                }
            }
        };
        for row in 0..DOF {
            self.error[row].0[lane] = closed.error[row];
        }
        put(&mut self.landmark, &closed.landmark);
        put(&mut self.translation, &closed.translation);
        put(&mut self.apart, &closed.apart);
        put(&mut self.beside, &closed.beside);
        for (side, (chain, random, coherent)) in self.sides.iter_mut().zip(&closed.odometry) {
            side.chains[lane] = *chain;
            put(&mut side.random, random);
            put(&mut side.coherent, coherent);
        }
    }
}

/// [`Sample::likelihoods`] for one set of vector instructions.
struct Compare<'a, const DOF: usize> {
    packs: &'a [Pack<DOF>],
    factors: &'a Calibration,
    shifted: bool,
    step: usize,
}

impl<const DOF: usize> WithSimd for Compare<'_, DOF> {
    type Output = Vec<Likelihoods>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut all = Vec::with_capacity(self.packs.len().div_ceil(self.step));
        for pack in self.packs.iter().step_by(self.step) {
            let mut found = Likelihoods::default();
            for lane in (0..WIDTH).step_by(S::F64_LANES) {
                self.compare(simd, pack, lane, &mut found);
            }
            all.push(found);
        }
        all
    }
}

impl<const DOF: usize> Compare<'_, DOF> {
    /// Compares the loops of one register.
    #[inline(always)]
    fn compare<S: Simd>(&self, simd: S, pack: &Pack<DOF>, lane: usize, found: &mut Likelihoods) {
        let zero = Lanes::splat(simd, 0.0);
        let mut error = [zero; DOF];
        for row in 0..DOF {
            error[row] = Lanes::load(simd, &pack.error[row], lane);
        }
        let mut covariance = [[zero; DOF]; DOF];
        add(simd, &mut covariance, &pack.landmark, Lanes::splat(simd, self.factors.landmark), lane);
        for side in &pack.sides {
            let (mut random, mut coherent) = (Wide::default(), Wide::default());
            for place in lane..lane + S::F64_LANES {
                random.0[place] = self.factors.odometry[side.chains[place]];
                coherent.0[place] = self.factors.coherent[side.chains[place]];
            }
            add(simd, &mut covariance, &side.random, Lanes::load(simd, &random, lane), lane);
            add(simd, &mut covariance, &side.coherent, Lanes::load(simd, &coherent, lane), lane);
        }
        let near = Eliminated::of(simd, covariance, error, &[Lanes::splat(simd, 1.0); DOF]);
        let wider = Wider { simd, covariance, error, near: &near, tail: self.factors.tail, lane };
        let correct = wider.by(&[(&pack.apart, 1.0)]);
        let [translation, turning] = self.factors.local_factors();
        let local =
            correct / wider.by(&[(&pack.landmark, turning), (&pack.translation, translation - turning)]);
        let shifted = if self.shifted { correct / wider.by(&[(&pack.beside, 1.0)]) } else { zero };
        // Leave out lanes with a pivot that is zero or negative, or with a value that is not a number.
        let one = Lanes::splat(simd, 1.0);
        let definite = zero.less_than(near.least);
        let known = (correct + local + shifted).less_than(Lanes::splat(simd, f64::INFINITY));
        let used = definite.and(known);
        used.select(correct, zero).store(&mut found.parts[0], lane);
        used.select(local, zero).store(&mut found.parts[1], lane);
        used.select(shifted, zero).store(&mut found.parts[2], lane);
        used.select(one, zero).store(&mut found.used, lane);
    }
}

/// Adds covariances, scaled by `share`.
#[inline(always)]
fn add<S: Simd, const DOF: usize>(
    simd: S,
    sum: &mut Symmetric<S, DOF>,
    covariance: &Stored<DOF>,
    share: Lanes<S>,
    lane: usize,
) {
    for row in 0..DOF {
        for column in 0..=row {
            sum[row][column] = sum[row][column] + Lanes::load(simd, &covariance[row][column], lane) * share;
        }
    }
}

/// L D L^T of covariances, applied to the errors at the same time.
struct Eliminated<S: Simd, const DOF: usize> {
    /// e^T S^-1 e
    squared: Lanes<S>,
    /// The product of the pivots, each multiplied by a scale.
    determinant: Lanes<S>,
    /// One over each pivot.
    inverse: [Lanes<S>; DOF],
    /// The smallest pivot: positive where the covariance is positive definite.
    least: Lanes<S>,
}

impl<S: Simd, const DOF: usize> Eliminated<S, DOF> {
    #[inline(always)]
    fn of(
        simd: S,
        mut left: Symmetric<S, DOF>,
        mut whitened: [Lanes<S>; DOF],
        scale: &[Lanes<S>; DOF],
    ) -> Self {
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        let (mut squared, mut determinant, mut inverse) = (zero, one, [zero; DOF]);
        let mut least = one;
        for column in 0..DOF {
            let pivot = left[column][column];
            let inverted = one / pivot;
            least = pivot.less_than(least).select(pivot, least);
            determinant = determinant * (pivot * scale[column]);
            squared = squared + whitened[column] * whitened[column] * inverted;
            inverse[column] = inverted;
            for later in column + 1..DOF {
                let ratio = left[later][column] * inverted;
                whitened[later] = whitened[later] - ratio * whitened[column];
                for row in later..DOF {
                    left[row][later] = left[row][later] - ratio * left[row][column];
                }
            }
        }
        Self { squared, determinant, inverse, least }
    }
}

/// Comparisons of a covariance with wider ones.
struct Wider<'a, S: Simd, const DOF: usize> {
    simd: S,
    covariance: Symmetric<S, DOF>,
    error: [Lanes<S>; DOF],
    near: &'a Eliminated<S, DOF>,
    tail: f64,
    lane: usize,
}

impl<S: Simd, const DOF: usize> Wider<'_, S, DOF> {
    /// t(e; S) / t(e; S + sum of share W)
    #[inline(always)]
    fn by<const TERMS: usize>(&self, wide: &[(&Stored<DOF>, f64); TERMS]) -> Lanes<S> {
        let mut covariance = self.covariance;
        for (wide, share) in wide {
            add(self.simd, &mut covariance, wide, Lanes::splat(self.simd, *share), self.lane);
        }
        let far = Eliminated::of(self.simd, covariance, self.error, &self.near.inverse);
        let tail = Lanes::splat(self.simd, self.tail);
        let mut base = (tail + far.squared) / (tail + self.near.squared);
        let degrees = self.tail as u32 + DOF as u32;
        let mut ratio = far.determinant.sqrt();
        if degrees % 2 == 1 {
            ratio = ratio * base.sqrt();
        }
        // To the power of degrees / 2, by squaring.
        let mut left = degrees / 2;
        while left > 0 {
            if left % 2 == 1 {
                ratio = ratio * base;
            }
            base = base * base;
            left /= 2;
        }
        ratio
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::SVector;
    use proptest::prelude::*;

    use super::*;

    /// A loop from numbers between -1 and 1, of any scale.
    fn closed<const DOF: usize>(numbers: &[f64], chain: usize) -> Loop<DOF> {
        let matrix = |turn: usize, scale: f64| {
            let root = SMatrix::<f64, DOF, DOF>::from_fn(|row, column| {
                numbers[(7 * row + column + 11 * turn) % numbers.len()]
            });
            (root * root.transpose() + SMatrix::identity() * 0.01) * scale
        };
        let error = SVector::from_fn(|row, _| numbers[(3 * row + 1) % numbers.len()]);
        Loop {
            error,
            landmark: matrix(0, 0.01),
            translation: matrix(0, 0.005),
            odometry: [(chain, matrix(1, 0.1), matrix(2, 1.0)), (2, matrix(3, 0.1), matrix(4, 1.0))],
            apart: matrix(5, 100.0),
            beside: matrix(6, 1.0),
        }
    }

    fn check<const DOF: usize>(numbers: &[Vec<f64>], factors: [f64; 5], tail: f64) {
        let [one, two, three, coherent, landmark] = factors.map(f64::exp);
        let calibration = Calibration {
            odometry: vec![one, two, three],
            coherent: vec![coherent; 3],
            landmark,
            errors: crate::calibration::LocalErrors::Exceptions,
            short: 1.0,
            correct: 0.5,
            local: 0.0,
            evidence: 0.0,
            on_prior: false,
            tail,
        };
        let mut sample = Sample::<DOF>::default();
        for (chain, numbers) in numbers.iter().enumerate() {
            sample.push(closed(numbers, chain % 2));
        }
        // A loop whose covariance is not positive definite.
        let mut bad = closed::<DOF>(&numbers[0], 0);
        bad.landmark = -SMatrix::identity() * 1e6;
        sample.push(bad);
        let packs = sample.likelihoods(&calibration, true, 1);
        let used: f64 = packs.iter().flat_map(|pack| pack.used.0).sum();
        assert_eq!(used, numbers.len() as f64);
        for (place, closed) in sample.loops().iter().enumerate().take(numbers.len()) {
            let evidence = calibration.evidence(closed).unwrap();
            let parts = packs[place / WIDTH].parts.map(|part| part.0[place % WIDTH].ln());
            let close = |value: f64, expected: f64| (value - expected).abs() < 1e-9 * (1.0 + expected.abs());
            assert!(close(parts[0], evidence.chance), "{} {}", parts[0], evidence.chance);
            assert!(close(parts[1], evidence.chance - evidence.local));
            let shifted = Loop { apart: closed.beside, ..closed.clone() };
            let shift = calibration.evidence(&shifted).unwrap().chance;
            assert!(close(parts[2], evidence.chance - shift));
        }
    }

    proptest! {
        #[test]
        fn several_loops_at_once_are_as_likely_as_one_by_one(
            numbers in prop::collection::vec(prop::collection::vec(-1.0..1.0, 40), 1..20),
            factors in [-5.0..5.0, -5.0..5.0, -5.0..5.0, -14.0..-4.0, -5.0..5.0_f64],
            tail in prop::sample::select(vec![4.0, 5.0]),
        ) {
            check::<3>(&numbers, factors, tail);
            check::<6>(&numbers, factors, tail);
        }
    }
}

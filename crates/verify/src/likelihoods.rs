//! Sums over the likelihoods of many loops under a mixture.

#![allow(
    clippy::inline_always,
    reason = "loops take the vector instructions of the caller they are inlined into"
)]

use std::ops::Range;

use posecut_geometry::lanes::{Lanes, WIDTH, Wide};
use pulp::{Arch, Simd, WithSimd};

/// Likelihoods of a few loops as correct ones, with a local error, and shifted, each relative to chance.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Likelihoods {
    pub(crate) parts: [Wide; 3],
    /// 1 for a loop, 0 in an unused lane or where the covariance is not positive definite.
    pub(crate) used: Wide,
}

/// Mixing proportions in the order of [`Likelihoods::parts`]; the rest is chance.
pub(crate) type Shares = [f64; 3];

/// Range in which products of likelihoods stay plain products. Outside it, their logarithm is taken.
const RANGE: Range<f64> = 1e-100..1e100;

/// Numbers of loops that are correct, locally wrong and shifted, each counted by its posterior probabilities.
pub(crate) fn counts(packs: &[Likelihoods], shares: &Shares) -> Shares {
    Arch::new().dispatch(Counts { packs, shares })
}

/// Log-likelihood of the mixture against that of chance alone.
pub(crate) fn gain(packs: &[Likelihoods], shares: &Shares) -> f64 {
    Arch::new().dispatch(Gain { packs, shares })
}

/// Mixing proportions in registers.
struct Mixture<S: Simd> {
    shares: [Lanes<S>; 3],
    chance: Lanes<S>,
}

impl<S: Simd> Mixture<S> {
    #[inline(always)]
    fn of(simd: S, shares: &Shares) -> Self {
        let [correct, local, shifted] = *shares;
        let chance = Lanes::splat(simd, 1.0 - (correct + local + shifted));
        Self { shares: shares.map(|share| Lanes::splat(simd, share)), chance }
    }

    /// The contribution of each part to the likelihood of a few loops, and the likelihood.
    #[inline(always)]
    fn weigh(&self, simd: S, parts: &[Wide; 3], lane: usize) -> ([Lanes<S>; 3], Lanes<S>) {
        let [first, second, third] = Lanes::load_three(simd, parts, lane);
        let [correct, local, shifted] = self.shares;
        let (first, second, third) = (first * correct, second * local, third * shifted);
        ([first, second, third], self.chance + first + second + third)
    }
}

struct Counts<'a> {
    packs: &'a [Likelihoods],
    shares: &'a Shares,
}

impl WithSimd for Counts<'_> {
    type Output = Shares;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Shares {
        let mixture = Mixture::of(simd, self.shares);
        let mut counts = [Wide::default(); 3];
        for Likelihoods { parts, used } in self.packs {
            for lane in (0..WIDTH).step_by(S::F64_LANES) {
                let ([first, second, third], likelihood) = mixture.weigh(simd, parts, lane);
                let share = Lanes::load(simd, used, lane) / likelihood;
                let [one, two, three] = Lanes::load_three(simd, &counts, lane);
                (one + first * share).store(&mut counts[0], lane);
                (two + second * share).store(&mut counts[1], lane);
                (three + third * share).store(&mut counts[2], lane);
            }
        }
        counts.map(|lanes| lanes.0.iter().sum())
    }
}

struct Gain<'a> {
    packs: &'a [Likelihoods],
    shares: &'a Shares,
}

impl WithSimd for Gain<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let mixture = Mixture::of(simd, self.shares);
        let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
        // The logarithm of products: one of each loop would cost more than all else.
        let (mut sum, mut product) = (0.0, Wide([1.0; WIDTH]));
        for Likelihoods { parts, used } in self.packs {
            for lane in (0..WIDTH).step_by(S::F64_LANES) {
                let (_, likelihood) = mixture.weigh(simd, parts, lane);
                let counted = zero.less_than(Lanes::load(simd, used, lane)).select(likelihood, one);
                (Lanes::load(simd, &product, lane) * counted).store(&mut product, lane);
            }
            if product.0.iter().any(|value| !RANGE.contains(value)) {
                sum += logarithm(&product);
                product = Wide([1.0; WIDTH]);
            }
        }
        sum + logarithm(&product)
    }
}

fn logarithm(product: &Wide) -> f64 {
    product.0.iter().map(|value| value.ln()).sum()
}

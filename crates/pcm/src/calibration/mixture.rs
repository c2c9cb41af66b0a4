//! Variance components of loops among false ones.

use std::f64::consts::PI;

use nalgebra::SMatrix;
use rayon::prelude::*;
use statrs::function::gamma::ln_gamma;

use super::loops::{CLASSES, Loop, Sample};
use super::{ScaleEstimate, Scales};
use crate::gate::chi_square_quantile;

/// Degrees of freedom of a correct loop's t distribution.
const TAIL: f64 = 4.0;
/// The share of correct loops at which the factors are read off: within their bulk, yet where a tail heavier than a
/// Gaussian's already shows. Re-admission takes the same.
const QUANTILE: f64 = 0.9;
/// Iterations end when both factors change by less than this, or after so many.
const TOLERANCE: f64 = 1e-3;
const ITERATIONS: usize = 300;
/// Both factors lie between e^-12 and e^12.
const RANGE: f64 = 12.0;
/// Loops that are summed one after the other; sums do not depend on the number of threads.
const CHUNK: usize = 256;

/// Both factors start from each of these; the likeliest end is taken.
const STARTS: [f64; 3] = [0.01, 1.0, 100.0];
/// So many iterations show which start leads farthest.
const TRIALS: usize = 40;

/// What one step of expectation-maximisation needs.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// For each class: loops, and the sum of the probabilities that they are correct.
    counts: [f64; CLASSES],
    correct: [f64; CLASSES],
    /// Squared distances that either part of the covariance accounts for, and as many as expected.
    seen: [f64; 2],
    expected: [f64; 2],
    log_likelihood: f64,
}

impl Sums {
    fn add(mut self, other: &Self) -> Self {
        for class in 0..CLASSES {
            self.counts[class] += other.counts[class];
            self.correct[class] += other.correct[class];
        }
        for part in 0..2 {
            self.seen[part] += other.seen[part];
            self.expected[part] += other.expected[part];
        }
        self.log_likelihood += other.log_likelihood;
        self
    }
}

/// The mixture's parameters: factors of odometry and landmark edges, share of correct loops of each class.
#[derive(Clone, Copy, Debug)]
struct Mixture {
    factors: [f64; 2],
    correct: [f64; CLASSES],
    log_volumes: [f64; CLASSES],
    /// The logarithm of the t density's constant.
    log_constant: f64,
}

/// A loop under some parameters: its inverse covariance, squared distance and probability of being correct.
struct Seen<const DOF: usize> {
    inverse: SMatrix<f64, DOF, DOF>,
    squared: f64,
    probability: f64,
    log_likelihood: f64,
}

impl Mixture {
    fn new<const DOF: usize>(log_volumes: [f64; CLASSES], start: f64) -> Self {
        let dimension = DOF as f64;
        let log_constant =
            ln_gamma(0.5 * (TAIL + dimension)) - ln_gamma(0.5 * TAIL) - 0.5 * dimension * (TAIL * PI).ln();
        Self { factors: [start; 2], correct: [0.5; CLASSES], log_volumes, log_constant }
    }

    /// `None` where the covariance is not positive definite.
    fn see<const DOF: usize>(&self, closed: &Loop<DOF>) -> Option<Seen<DOF>> {
        let covariance = closed.odometry * self.factors[0] + closed.landmark * self.factors[1];
        let cholesky = covariance.cholesky()?;
        let squared = closed.error.dot(&cholesky.solve(&closed.error));
        let log_root: f64 = cholesky.l_dirty().diagonal().iter().map(|term| term.ln()).sum();
        let log_correct =
            self.log_constant - log_root - 0.5 * (TAIL + DOF as f64) * (1.0 + squared / TAIL).ln();
        let share = self.correct[closed.class];
        // Logarithms of both terms of the mixture.
        let (correct, wrong) =
            (share.ln() + log_correct, (1.0 - share).ln() - self.log_volumes[closed.class]);
        let log_likelihood = correct.max(wrong) + (-(correct - wrong).abs()).exp().ln_1p();
        let probability = 1.0 / (1.0 + (wrong - correct).exp());
        log_likelihood.is_finite().then(|| Seen {
            inverse: cholesky.inverse(),
            squared,
            probability,
            log_likelihood,
        })
    }

    fn sums<const DOF: usize>(&self, loops: &[Loop<DOF>]) -> Sums {
        let mut sums = Sums::default();
        for closed in loops {
            let Some(seen) = self.see(closed) else { continue };
            sums.counts[closed.class] += 1.0;
            sums.correct[closed.class] += seen.probability;
            sums.log_likelihood += seen.log_likelihood;
            let weight = seen.probability * (TAIL + DOF as f64) / (TAIL + seen.squared);
            let whitened = seen.inverse * closed.error;
            for (part, covariance) in [&closed.odometry, &closed.landmark].into_iter().enumerate() {
                sums.seen[part] += weight * whitened.dot(&(covariance * whitened));
                sums.expected[part] += seen.probability * seen.inverse.dot(covariance);
            }
        }
        sums
    }

    /// One step; how far the factors moved, and the likelihood before.
    fn step<const DOF: usize>(&mut self, loops: &[Loop<DOF>]) -> (f64, f64) {
        let parts: Vec<Sums> = loops.par_chunks(CHUNK).map(|chunk| self.sums(chunk)).collect();
        let sums = parts.iter().fold(Sums::default(), Sums::add);
        for class in 0..CLASSES {
            if sums.counts[class] > 0.0 {
                self.correct[class] = (sums.correct[class] / sums.counts[class]).clamp(0.001, 0.999);
            }
        }
        let mut moved = 0.0;
        for part in 0..2 {
            // Without odometry between the candidates nothing is known of it.
            if sums.expected[part] > 0.0 {
                let ratio = sums.seen[part] / sums.expected[part];
                let factor = (self.factors[part] * ratio.sqrt()).clamp((-RANGE).exp(), RANGE.exp());
                moved += (factor / self.factors[part]).ln().abs();
                self.factors[part] = factor;
            }
        }
        (moved, sums.log_likelihood)
    }

    /// Steps until nothing moves; the mixture with its likelihood.
    fn settle<const DOF: usize>(mut self, loops: &[Loop<DOF>], iterations: usize) -> (Self, f64) {
        let mut likelihood = f64::NEG_INFINITY;
        for _ in 0..iterations {
            let (moved, before) = self.step(loops);
            likelihood = before;
            if moved < TOLERANCE {
                break;
            }
        }
        (self, likelihood)
    }
}

/// Fits the mixture; `None` if no loop's covariance is positive definite.
pub(super) fn fit<const DOF: usize>(sample: &Sample<DOF>) -> Option<ScaleEstimate> {
    let (trial, _) = STARTS
        .map(|start| Mixture::new::<DOF>(sample.log_volumes, start).settle(&sample.loops, TRIALS))
        .into_iter()
        .max_by(|one, other| one.1.total_cmp(&other.1))?;
    let (mixture, _) = trial.settle(&sample.loops, ITERATIONS);
    let mut seen: Vec<(f64, f64)> = sample
        .loops
        .iter()
        .filter_map(|closed| mixture.see(closed))
        .map(|seen| (seen.squared, seen.probability))
        .collect();
    let tail = weighted_quantile(&mut seen, QUANTILE)? / chi_square_quantile(QUANTILE, DOF).ok()?;
    let [odometry, landmark] = mixture.factors.map(|factor| factor * tail);
    let scales = Scales { odometry, landmark };
    (odometry > 0.0 && landmark > 0.0).then_some(ScaleEstimate {
        scales,
        correct: mixture.correct[0],
        loops: seen.len(),
    })
}

/// The value below which a share of the weights lies.
fn weighted_quantile(values: &mut [(f64, f64)], share: f64) -> Option<f64> {
    values.sort_by(|one, other| one.0.total_cmp(&other.0));
    let total: f64 = values.iter().map(|&(_, weight)| weight).sum();
    let mut sum = 0.0;
    values.iter().find_map(|&(value, weight)| {
        sum += weight;
        (sum >= share * total).then_some(value)
    })
}

//! Fits the variance components of correct loops among false ones.

use std::f64::consts::PI;

use nalgebra::{DMatrix, SVector};
use rayon::prelude::*;
use statrs::function::gamma::ln_gamma;

use super::loops::{CLASSES, Loop, Sample};
use super::{Ended, ScaleEstimate, Scales};
use crate::pairs::gate::chi_square_quantile;

/// Degrees of freedom of a correct loop's t distribution.
const TAIL: f64 = 4.0;
/// The quantile of the correct loops' squared distances that fixes the factors: within their bulk, yet far enough out to
/// show tails heavier than a Gaussian's. Re-admission uses the same one.
const QUANTILE: f64 = 0.9;
/// Iterations end when both factors change by less than this, or after this many.
const TOLERANCE: f64 = 1e-3;
const ITERATIONS: usize = 300;
/// Both factors lie between e^-12 and e^12.
const RANGE: f64 = 12.0;
/// The share of correct loops stays at least this far from 0 and from 1.
const LEAST_CORRECT: f64 = 0.001;
/// Loops that one task adds up in order. The chunks are fixed, so that sums do not depend on the number of threads.
const CHUNK: usize = 256;

/// Initial values of both factors. The fit of highest likelihood is taken.
const STARTS: [f64; 3] = [0.01, 1.0, 100.0];
/// The number of iterations after which the starts are compared.
const TRIALS: usize = 40;

/// The sums that one step of expectation-maximisation needs.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// For each class: the number of loops, and the sum of the probabilities that they are correct.
    counts: [f64; CLASSES],
    correct: [f64; CLASSES],
    /// For each part of the covariance: the squared distance that it accounts for, and its expected value.
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

/// The mixture's parameters: the factors of odometry and landmark edges, and the share of correct loops of each class.
#[derive(Clone, Copy, Debug)]
struct Mixture {
    factors: [f64; 2],
    correct: [f64; CLASSES],
    log_volumes: [f64; CLASSES],
    /// The logarithm of the t density's constant.
    log_constant: f64,
}

/// A loop in the axes that make both parts of its covariance diagonal: with the landmark edges' part L = C C^T and
/// C^-1 O C^-T = U diag(d) U^T, a O + b L is C U (a diag(d) + b) U^T C^T. An iteration then costs O(DOF) a loop instead
/// of a factorisation.
#[derive(Clone, Debug)]
struct Diagonal<const DOF: usize> {
    class: usize,
    /// ln |C|
    log_root: f64,
    /// d, the odometry's share relative to the landmark edges'.
    odometry: SVector<f64, DOF>,
    /// Squares of U^T C^-1 e.
    squares: SVector<f64, DOF>,
}

impl<const DOF: usize> Diagonal<DOF> {
    /// `None` where the landmark edges' part is not positive definite.
    fn of(closed: &Loop<DOF>) -> Option<Self> {
        let root = closed.landmark.cholesky()?.unpack();
        let log_root = root.diagonal().iter().map(|term| term.ln()).sum();
        let half = root.solve_lower_triangular(&closed.odometry)?;
        let whitened = root.solve_lower_triangular(&half.transpose())?;
        let error = root.solve_lower_triangular(&closed.error)?;
        let symmetric = DMatrix::from_fn(DOF, DOF, |row, column| {
            0.5 * (whitened[(row, column)] + whitened[(column, row)])
        });
        if !symmetric.iter().all(|entry| entry.is_finite()) {
            return None;
        }
        let eigen = symmetric.symmetric_eigen();
        let squares = SVector::from_fn(|axis, _| {
            let along: f64 =
                eigen.eigenvectors.column(axis).iter().zip(&error).map(|(one, other)| one * other).sum();
            along * along
        });
        // Rounding may make a direction without odometry slightly negative.
        let odometry = SVector::from_fn(|axis, _| eigen.eigenvalues[axis].max(0.0));
        Some(Self { class: closed.class, log_root, odometry, squares })
    }
}

/// A loop under given parameters: the inverse of its diagonal covariance, its squared distance and its probability of being
/// correct.
struct Seen<const DOF: usize> {
    inverse: SVector<f64, DOF>,
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

    /// `None` if the likelihood is not a finite number.
    fn see<const DOF: usize>(&self, closed: &Diagonal<DOF>) -> Option<Seen<DOF>> {
        let covariance = closed.odometry.map(|odometry| self.factors[0] * odometry + self.factors[1]);
        let inverse = covariance.map(f64::recip);
        let squared = closed.squares.dot(&inverse);
        // Six factors of at most e^12 times a ratio of variances are far from overflow, and one logarithm is cheaper than
        // six.
        let log_root = closed.log_root + 0.5 * covariance.product().ln();
        let log_correct =
            self.log_constant - log_root - 0.5 * (TAIL + DOF as f64) * (1.0 + squared / TAIL).ln();
        let share = self.correct[closed.class];
        // Logarithms of both terms of the mixture.
        let (correct, wrong) =
            (share.ln() + log_correct, (1.0 - share).ln() - self.log_volumes[closed.class]);
        let log_likelihood = correct.max(wrong) + (-(correct - wrong).abs()).exp().ln_1p();
        let probability = 1.0 / (1.0 + (wrong - correct).exp());
        log_likelihood.is_finite().then_some(Seen { inverse, squared, probability, log_likelihood })
    }

    fn sums<const DOF: usize>(&self, loops: &[Diagonal<DOF>]) -> Sums {
        let mut sums = Sums::default();
        for closed in loops {
            let Some(seen) = self.see(closed) else { continue };
            sums.counts[closed.class] += 1.0;
            sums.correct[closed.class] += seen.probability;
            sums.log_likelihood += seen.log_likelihood;
            let weight = seen.probability * (TAIL + DOF as f64) / (TAIL + seen.squared);
            // Squares of the whitened error; the landmark edges' part is the identity in these axes.
            let whitened = closed.squares.component_mul(&seen.inverse).component_mul(&seen.inverse);
            sums.seen[0] += weight * whitened.dot(&closed.odometry);
            sums.seen[1] += weight * whitened.sum();
            sums.expected[0] += seen.probability * seen.inverse.dot(&closed.odometry);
            sums.expected[1] += seen.probability * seen.inverse.sum();
        }
        sums
    }

    /// One step. Returns how far the factors moved, and the likelihood before the step.
    fn step<const DOF: usize>(&mut self, loops: &[Diagonal<DOF>]) -> (f64, f64) {
        let parts: Vec<Sums> = loops.par_chunks(CHUNK).map(|chunk| self.sums(chunk)).collect();
        let sums = parts.iter().fold(Sums::default(), Sums::add);
        for class in 0..CLASSES {
            if sums.counts[class] > 0.0 {
                self.correct[class] =
                    (sums.correct[class] / sums.counts[class]).clamp(LEAST_CORRECT, 1.0 - LEAST_CORRECT);
            }
        }
        let mut moved = 0.0;
        for part in 0..2 {
            // Without odometry between the candidates, the loops say nothing about its factor.
            if sums.expected[part] > 0.0 {
                let ratio = sums.seen[part] / sums.expected[part];
                let factor = (self.factors[part] * ratio.sqrt()).clamp((-RANGE).exp(), RANGE.exp());
                moved += (factor / self.factors[part]).ln().abs();
                self.factors[part] = factor;
            }
        }
        (moved, sums.log_likelihood)
    }

    /// Iterates until the factors converge. Returns the mixture, its likelihood, and whether it converged.
    fn settle<const DOF: usize>(mut self, loops: &[Diagonal<DOF>], iterations: usize) -> (Self, f64, bool) {
        let mut likelihood = f64::NEG_INFINITY;
        for _ in 0..iterations {
            let (moved, before) = self.step(loops);
            likelihood = before;
            if moved < TOLERANCE {
                return (self, likelihood, true);
            }
        }
        (self, likelihood, false)
    }

    /// The bound at which a fit ended.
    fn bound(&self) -> Option<Ended> {
        let any = |factor: f64| self.factors.contains(&factor);
        if any((-RANGE).exp()) {
            Some(Ended::SmallestFactor)
        } else if any(RANGE.exp()) {
            Some(Ended::LargestFactor)
        } else {
            (self.correct[0] <= LEAST_CORRECT).then_some(Ended::Share)
        }
    }
}

/// The start of highest likelihood after a few iterations, with that likelihood.
fn trial<const DOF: usize>(
    loops: &[Diagonal<DOF>],
    log_volumes: [f64; CLASSES],
) -> Option<(Mixture, f64, bool)> {
    STARTS
        .map(|start| Mixture::new::<DOF>(log_volumes, start).settle(loops, TRIALS))
        .into_iter()
        .max_by(|one, other| one.1.total_cmp(&other.1))
}

/// Fits the mixture. `None` if no loop's covariance is positive definite.
pub(super) fn fit<const DOF: usize>(sample: &Sample<DOF>) -> Option<ScaleEstimate> {
    let diagonal =
        |loops: &[Loop<DOF>]| -> Vec<Diagonal<DOF>> { loops.par_iter().filter_map(Diagonal::of).collect() };
    let (loops, elsewhere) = (diagonal(&sample.loops), diagonal(&sample.elsewhere));
    let (mixture, likelihood, settled) = trial(&loops, sample.log_volumes)?.0.settle(&loops, ITERATIONS);
    let (_, by_chance, _) = trial(&elsewhere, sample.log_volumes)?;
    let mut seen: Vec<(f64, f64)> = loops
        .iter()
        .filter_map(|closed| mixture.see(closed))
        .map(|seen| (seen.squared, seen.probability))
        .collect();
    let tail = weighted_quantile(&mut seen, QUANTILE)? / chi_square_quantile(QUANTILE, DOF).ok()?;
    let [odometry, landmark] = mixture.factors.map(|factor| factor * tail);
    let scales = Scales { odometry, landmark };
    // Loops through the same edge are not independent: an edge counts once.
    let share = sample.edges as f64 / loops.len().max(1) as f64;
    (odometry > 0.0 && landmark > 0.0).then_some(ScaleEstimate {
        scales,
        correct: mixture.correct[0],
        loops: seen.len(),
        edges: sample.edges,
        evidence: (likelihood - by_chance) * share,
        ended: mixture.bound().or((!settled).then_some(Ended::Iterations)),
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SMatrix;
    use proptest::prelude::*;

    proptest! {
        /// Distance and determinant are those of a O + b L.
        #[test]
        fn the_diagonal_form_is_the_loop(
            entries in proptest::collection::vec(-1.0_f64..1.0, 78),
            odometry in 0.01_f64..100.0,
            landmark in 0.01_f64..100.0,
        ) {
            // A rank of five: a direction without odometry.
            let root = SMatrix::<f64, 6, 5>::from_column_slice(&entries[..30]);
            let other = SMatrix::<f64, 6, 6>::from_column_slice(&entries[30..66]);
            let closed = Loop {
                class: 0,
                error: SVector::<f64, 6>::from_column_slice(&entries[66..72]),
                odometry: root * root.transpose(),
                landmark: other * other.transpose() + SMatrix::identity() * 0.1,
            };
            let diagonal = Diagonal::of(&closed).unwrap();
            let mut mixture = Mixture::new::<6>([0.0; CLASSES], 1.0);
            mixture.factors = [odometry, landmark];
            let seen = mixture.see(&diagonal).unwrap();
            let cholesky = (closed.odometry * odometry + closed.landmark * landmark).cholesky().unwrap();
            let squared = closed.error.dot(&cholesky.solve(&closed.error));
            prop_assert!((seen.squared - squared).abs() <= 1e-8 * squared.max(1.0), "{} {squared}", seen.squared);
            let log_root: f64 = cholesky.l().diagonal().iter().map(|term| term.ln()).sum();
            let spread: f64 = seen.inverse.iter().map(|term| -0.5 * term.ln()).sum();
            prop_assert!((diagonal.log_root + spread - log_root).abs() < 1e-8);
        }
    }
}

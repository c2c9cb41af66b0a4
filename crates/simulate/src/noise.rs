//! Noise of sensors.

use posecut_random::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// A normally distributed number with mean 0 and the given standard deviation.
pub(crate) fn normal(random: &mut ChaCha8Rng, sigma: f64) -> f64 {
    let unit: f64 = StandardNormal.sample(random);
    sigma * unit
}

/// Correlated noise: an Ornstein-Uhlenbeck process with the given standard deviation and correlation length (seconds or
/// metres).
#[derive(Clone, Debug)]
pub(crate) struct Wander {
    value: f64,
    sigma: f64,
    length: f64,
}

impl Wander {
    /// Starts in the stationary distribution.
    pub(crate) fn new(random: &mut ChaCha8Rng, sigma: f64, length: f64) -> Self {
        Self { value: normal(random, sigma), sigma, length }
    }

    /// The value after a step.
    pub(crate) fn step(&mut self, random: &mut ChaCha8Rng, step: f64) -> f64 {
        let kept = (-step / self.length).exp();
        self.value = kept * self.value + normal(random, self.sigma * (1.0 - kept * kept).sqrt());
        self.value
    }
}

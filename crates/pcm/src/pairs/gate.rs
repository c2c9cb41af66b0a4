//! How far apart two edges may be and still count as consistent.

use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::PcmError;

/// What is compared with what.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Test {
    /// Squared Mahalanobis distance against a chi-square quantile: correct pairs pass with the given probability
    Mahalanobis,
    /// Mahalanobis distance, not squared, against the same quantile, as in some public code: many false pairs pass too
    Root,
    /// Error of the loop in metres and radians per step; covariances are not read
    Threshold,
}

/// What the probability of a gate refers to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Correction {
    /// One pair: large groups lose some correct edges, because each edge must agree with all others
    #[default]
    Pair,
    /// All pairs of a group together (Bonferroni): a much wider gate, which keeps nearly all correct edges
    Group,
}

/// The condition for a consistent pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// The largest squared Mahalanobis distance; not used if `per_step` is set.
    pub squared_distance: f64,
    /// The largest error of a loop per step, in place of the distance (`Test::Threshold`).
    pub per_step: Option<PerStep>,
}

/// Errors of a loop divided by the number of its steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PerStep {
    /// Metres.
    pub translation: f64,
    /// Radians.
    pub rotation: f64,
}

impl Gate {
    /// The gate that passes true pairs with the given probability (`Test::Mahalanobis`); with `Test::Root`
    /// the same quantile bounds the distance itself, so its square bounds the squared distance.
    pub fn new(test: Test, probability: f64, degrees_of_freedom: usize) -> Result<Self, PcmError> {
        let quantile = chi_square_quantile(probability, degrees_of_freedom)?;
        let squared_distance = if test == Test::Root { quantile * quantile } else { quantile };
        Ok(Self { squared_distance, per_step: None })
    }

    /// The gate on errors per step.
    pub fn per_step(translation: f64, rotation: f64) -> Self {
        Self { squared_distance: f64::INFINITY, per_step: Some(PerStep { translation, rotation }) }
    }
}

/// The probability with which each pair must pass, so that all pairs of N candidates pass with the given probability:
/// 1 - (1 - P) / (N (N - 1) / 2).
pub fn corrected(probability: f64, correction: Correction, candidates: usize) -> f64 {
    match correction {
        Correction::Pair => probability,
        Correction::Group => {
            let pairs = (candidates * candidates.saturating_sub(1) / 2).max(1);
            // A smaller complement of the probability would be lost in rounding.
            1.0 - ((1.0 - probability) / pairs as f64).max(1e-14)
        }
    }
}

/// The value that a chi-square variable is below with this probability.
///
/// Uses bisection of the upper tail, which keeps its digits if the probability is near 1.
pub fn chi_square_quantile(probability: f64, degrees_of_freedom: usize) -> Result<f64, PcmError> {
    let refused = PcmError::Probability { value: probability };
    if !(probability > 0.0 && probability < 1.0) {
        return Err(refused);
    }
    let Ok(distribution) = ChiSquared::new(degrees_of_freedom as f64) else { return Err(refused) };
    let tail = 1.0 - probability;
    let (mut low, mut high) = (0.0, 1.0);
    while distribution.sf(high) > tail {
        high *= 2.0;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if distribution.sf(middle) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_agree_with_the_tables() {
        // Chi-square table: 3 degrees of freedom, 0.99 -> 11.345; 6 degrees, 0.95 -> 12.592.
        let three = chi_square_quantile(0.99, 3).unwrap();
        let six = chi_square_quantile(0.95, 6).unwrap();
        assert!((three - 11.345).abs() < 1e-3 && (six - 12.592).abs() < 1e-3, "{three} {six}");
        let root = Gate::new(Test::Root, 0.99, 3).unwrap().squared_distance;
        assert!((root - 11.345_f64.powi(2)).abs() < 0.02, "{root}");
    }

    #[test]
    fn quantiles_far_in_the_tail_keep_their_digits() {
        // scipy.stats.chi2.isf(1e-6, 3) and (1e-12, 6).
        let near = chi_square_quantile(1.0 - 1e-6, 3).unwrap();
        let far = chi_square_quantile(1.0 - 1e-12, 6).unwrap();
        assert!((near - 30.664_85).abs() < 1e-3, "{near}");
        assert!((far - 68.104_7).abs() < 1e-2, "{far}");
    }

    #[test]
    fn probabilities_outside_the_open_interval_are_refused() {
        for probability in [0.0, 1.0, -0.5, f64::NAN] {
            assert!(Gate::new(Test::Mahalanobis, probability, 3).is_err());
        }
    }

    #[test]
    fn a_gate_for_the_group_is_looser() {
        assert_eq!(corrected(0.99, Correction::Pair, 1000), 0.99);
        let looser = corrected(0.99, Correction::Group, 1000);
        assert!((1.0 - looser - 0.01 / 499_500.0).abs() < 1e-15, "{looser}");
        assert_eq!(corrected(0.99, Correction::Group, 1), 0.99);
    }
}

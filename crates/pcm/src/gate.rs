//! How far apart two edges may be and still count as consistent.

use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::PcmError;

/// What is compared with the chi-square quantile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Test {
    /// The squared Mahalanobis distance, which is chi-square distributed: passes the stated share of true pairs
    Mahalanobis,
    /// Its square root, as some public code does: passes nearly every true pair, and many false ones
    Root,
}

/// The largest squared Mahalanobis distance of a consistent pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// The threshold on the squared distance.
    pub squared_distance: f64,
}

impl Gate {
    /// The gate that passes true pairs with the given probability (`Test::Mahalanobis`); with `Test::Root`
    /// the same quantile bounds the distance itself, so its square bounds the squared distance.
    pub fn new(test: Test, probability: f64, degrees_of_freedom: usize) -> Result<Self, PcmError> {
        let refused = PcmError::Probability { value: probability };
        if !(probability > 0.0 && probability < 1.0) {
            return Err(refused);
        }
        let Ok(distribution) = ChiSquared::new(degrees_of_freedom as f64) else { return Err(refused) };
        let quantile = distribution.inverse_cdf(probability);
        let squared_distance = match test {
            Test::Mahalanobis => quantile,
            Test::Root => quantile * quantile,
        };
        Ok(Self { squared_distance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_agree_with_the_tables() {
        // Chi-square table: 3 degrees of freedom, 0.99 -> 11.345; 6 degrees, 0.95 -> 12.592.
        let three = Gate::new(Test::Mahalanobis, 0.99, 3).unwrap().squared_distance;
        let six = Gate::new(Test::Mahalanobis, 0.95, 6).unwrap().squared_distance;
        assert!((three - 11.345).abs() < 1e-3 && (six - 12.592).abs() < 1e-3, "{three} {six}");
        let root = Gate::new(Test::Root, 0.99, 3).unwrap().squared_distance;
        assert!((root - 11.345_f64.powi(2)).abs() < 0.02, "{root}");
    }

    #[test]
    fn probabilities_outside_the_open_interval_are_refused() {
        for probability in [0.0, 1.0, -0.5, f64::NAN] {
            assert!(Gate::new(Test::Mahalanobis, probability, 3).is_err());
        }
    }
}

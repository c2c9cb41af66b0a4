//! Statistics of errors, with the names that are usual in SLAM.

use serde::Serialize;

/// Statistics of non-negative errors, defined as in evo: `std` is that of the population, and the median of an even
/// number of errors is the mean of the middle two.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Root mean square.
    pub rmse: f64,
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Standard deviation.
    pub std: f64,
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
    /// Sum of squares.
    pub sse: f64,
    /// Number of errors.
    pub count: usize,
}

impl Summary {
    /// The statistics of some errors; `None` without any. O(n log n).
    pub fn of(errors: &[f64]) -> Option<Self> {
        if errors.is_empty() {
            return None;
        }
        let count = errors.len() as f64;
        let sse: f64 = errors.iter().map(|error| error * error).sum();
        let mean = errors.iter().sum::<f64>() / count;
        let variance = errors.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / count;
        let mut sorted = errors.to_vec();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted.len() / 2;
        let median =
            if sorted.len() % 2 == 1 { sorted[middle] } else { 0.5 * (sorted[middle - 1] + sorted[middle]) };
        Some(Self {
            rmse: (sse / count).sqrt(),
            mean,
            median,
            std: variance.sqrt(),
            min: sorted[0],
            max: sorted[sorted.len() - 1],
            sse,
            count: errors.len(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_a_small_sample_by_hand() {
        let summary = Summary::of(&[1.0, 2.0, 3.0, 6.0]).unwrap();
        assert_eq!((summary.mean, summary.median, summary.sse), (3.0, 2.5, 50.0));
        assert_eq!((summary.min, summary.max, summary.count), (1.0, 6.0, 4));
        assert!((summary.rmse - 12.5_f64.sqrt()).abs() < 1e-15);
        assert!((summary.std - 3.5_f64.sqrt()).abs() < 1e-15);
        assert_eq!(Summary::of(&[]), None);
    }
}

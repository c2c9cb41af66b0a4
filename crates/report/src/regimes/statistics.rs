//! Confidence intervals and tests over seeds. RMSE over seeds is skewed and often bimodal (a false edge was kept, or
//! none was), so nothing here assumes a normal distribution.

use posecut_stage::ChaCha8Rng;
use posecut_stage::rand::Rng as _;

/// The level of all intervals.
pub const CONFIDENCE: f64 = 0.95;

/// Resamples of a bootstrap.
pub const RESAMPLES: usize = 2000;

/// The largest number of differences for which all sign patterns are tried. Above it, [`FLIPS`] random ones are.
const ALL_FLIPS: usize = 12;

/// Number of random sign patterns.
const FLIPS: usize = 9999;

/// The 95 % interval of the mean by the percentile bootstrap (Efron and Tibshirani 1993, chapter 13), with 2000
/// resamples. Values come in strata (sessions). Each stratum is resampled separately, and all have equal weight: the
/// mean is the mean of the strata's means. `None` if there is no stratum or one is empty.
pub fn bootstrap_interval(strata: &[Vec<f64>], random: &mut ChaCha8Rng) -> Option<(f64, f64)> {
    mean_of_means(strata)?;
    if strata.iter().all(|values| values.iter().all(|value| *value == values[0])) {
        let mean = mean_of_means(strata)?;
        return Some((mean, mean));
    }
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let sum: f64 = strata
                .iter()
                .map(|values| {
                    let total: f64 = values.iter().map(|_| values[below(values.len(), random)]).sum();
                    total / values.len() as f64
                })
                .sum();
            sum / strata.len() as f64
        })
        .collect();
    means.sort_by(f64::total_cmp);
    let tail = (1.0 - CONFIDENCE) / 2.0;
    let at = |share: f64| means[((RESAMPLES - 1) as f64 * share).round() as usize];
    Some((at(tail), at(1.0 - tail)))
}

/// The mean of the strata's means.
pub fn mean_of_means(strata: &[Vec<f64>]) -> Option<f64> {
    if strata.is_empty() || strata.iter().any(Vec::is_empty) {
        return None;
    }
    let sum: f64 = strata.iter().map(|values| values.iter().sum::<f64>() / values.len() as f64).sum();
    Some(sum / strata.len() as f64)
}

/// The two-sided p-value of paired differences under the hypothesis that each is as likely with the opposite sign
/// (Fisher's randomisation test of the mean): the share of sign patterns whose mean is at least as far from zero as the
/// observed one. Uses all patterns for up to 12 differences, otherwise 9999 random ones and the observed one. Strata
/// have equal weight, as in [`bootstrap_interval`]. The p-value is 1 without differences.
pub fn sign_flip_p(strata: &[Vec<f64>], random: &mut ChaCha8Rng) -> f64 {
    let weighed: Vec<f64> = strata
        .iter()
        .flat_map(|values| values.iter().map(|value| value / values.len() as f64))
        .filter(|value| *value != 0.0)
        .collect();
    if weighed.is_empty() {
        return 1.0;
    }
    // A pattern whose mean differs from the observed one only by rounding counts as reaching it.
    let scale: f64 = weighed.iter().map(|value| value.abs()).sum();
    let observed = weighed.iter().sum::<f64>().abs() - 1e-12 * scale;
    let reaches = |signs: &dyn Fn(usize) -> bool| {
        let sum: f64 =
            weighed.iter().enumerate().map(|(index, value)| if signs(index) { -value } else { *value }).sum();
        sum.abs() >= observed
    };
    if weighed.len() <= ALL_FLIPS {
        let patterns = 1_usize << weighed.len();
        let reached = (0..patterns).filter(|pattern| reaches(&|index| pattern >> index & 1 == 1)).count();
        return reached as f64 / patterns as f64;
    }
    let mut bits = vec![0_u64; weighed.len().div_ceil(64)];
    let reached = (0..FLIPS)
        .filter(|_| {
            for word in &mut bits {
                *word = random.next_u64();
            }
            reaches(&|index| bits[index / 64] >> (index % 64) & 1 == 1)
        })
        .count();
    // The observed pattern counts too, so the p-value is never 0.
    (reached + 1) as f64 / (FLIPS + 1) as f64
}

/// P-values adjusted for the false discovery rate (Benjamini and Hochberg 1995): among the adjusted values below a
/// level, the expected share of false discoveries is at most that level. O(n log n).
pub fn adjusted(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&one, &other| values[other].total_cmp(&values[one]));
    let mut result = vec![1.0; count];
    let mut least = 1.0_f64;
    for (place, &index) in order.iter().enumerate() {
        least = least.min(values[index] * count as f64 / (count - place) as f64);
        result[index] = least;
    }
    result
}

/// A random number below `count`, by multiplication. It deviates from uniform by less than count / 2^64.
fn below(count: usize, random: &mut ChaCha8Rng) -> usize {
    ((u128::from(random.next_u64()) * count as u128) >> 64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use posecut_stage::random;

    #[test]
    fn intervals_of_normal_samples_cover_the_mean_about_as_often_as_they_say() {
        let mut source = random(5, "samples");
        let mut uniform = move || (source.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let covered = (0..300)
            .filter(|_| {
                // The sum of twelve uniform numbers: mean 6, nearly normal.
                let sample: Vec<f64> = (0..20).map(|_| (0..12).map(|_| uniform()).sum()).collect();
                let (low, high) = bootstrap_interval(&[sample], &mut random(1, "test")).unwrap();
                low <= 6.0 && 6.0 <= high
            })
            .count();
        // The percentile bootstrap of 20 values covers a little less than 95 %.
        assert!((265..=294).contains(&covered), "{covered} of 300");
    }

    #[test]
    fn equal_values_have_an_interval_of_no_width_and_empty_strata_none() {
        let interval = bootstrap_interval(&[vec![2.0; 5], vec![4.0; 2]], &mut random(1, "test"));
        assert_eq!(interval, Some((3.0, 3.0)));
        assert_eq!(bootstrap_interval(&[vec![1.0], vec![]], &mut random(1, "test")), None);
        assert_eq!(bootstrap_interval(&[], &mut random(1, "test")), None);
    }

    #[test]
    fn sign_flips_by_hand() {
        let mut generator = random(1, "test");
        // Of eight patterns of 1, 2, 3, two reach a sum of 6.
        assert_eq!(sign_flip_p(&[vec![1.0, 2.0, 3.0]], &mut generator), 0.25);
        // Sums of the patterns of 1, 2, -3 are 0 (twice), 2, 4, 6 and their negatives: all reach 0.
        assert_eq!(sign_flip_p(&[vec![1.0, 2.0, -3.0]], &mut generator), 1.0);
        assert_eq!(sign_flip_p(&[vec![0.0; 8]], &mut generator), 1.0);
        assert_eq!(sign_flip_p(&[], &mut generator), 1.0);
    }

    #[test]
    fn many_differences_of_one_sign_are_as_unlikely_as_random_patterns_can_tell() {
        let mut generator = random(1, "test");
        assert_eq!(sign_flip_p(&[vec![1.0; 20]], &mut generator), 1e-4);
        let half: Vec<f64> = (0..20).map(|index| if index % 2 == 0 { 1.0 } else { -1.0 }).collect();
        assert!(sign_flip_p(&[half], &mut generator) > 0.9);
    }

    #[test]
    fn false_discoveries_are_controlled_as_in_the_published_example() {
        // Benjamini and Hochberg 1995, section 3.2: of these fifteen, four are significant at 0.05.
        let values = [
            0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344, 0.0459, 0.3240, 0.4262, 0.5719,
            0.6528, 0.7590, 1.0,
        ];
        let adjusted = adjusted(&values);
        assert_eq!(adjusted.iter().filter(|value| **value <= 0.05).count(), 4);
        assert!((adjusted[3] - 0.0095 * 15.0 / 4.0).abs() < 1e-12);
        assert!(adjusted.windows(2).all(|pair| pair[0] <= pair[1]));
    }
}

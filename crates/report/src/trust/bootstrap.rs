//! Confidence intervals from clusters. The seeds and grid points of one session share its odometry and its correct
//! edges. Clusters are therefore resampled as a whole, within each family (Davison and Hinkley 1997, section 3.8).

use posecut_stage::ChaCha8Rng;
use posecut_stage::rand::Rng as _;

use crate::regimes::statistics::{CONFIDENCE, RESAMPLES};

/// The contribution of a cluster to a pooled ratio. For a mean it is a sum and a number of runs, for a recall the
/// number of kept edges and of correct edges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    /// The numerator.
    pub above: f64,
    /// The denominator.
    pub below: f64,
}

/// The pooled ratio over all clusters; `None` if its denominator is zero.
pub fn ratio<'a>(parts: impl Iterator<Item = &'a Part>) -> Option<f64> {
    let sum = parts.fold(Part::default(), |sum, part| Part {
        above: sum.above + part.above,
        below: sum.below + part.below,
    });
    (sum.below > 0.0).then(|| sum.above / sum.below)
}

/// The 95 % percentile interval of the pooled ratio, from 2000 resamples of the clusters of each stratum (family).
/// `None` if no stratum has two clusters, because the variation between clusters is then unknown.
pub fn interval(strata: &[Vec<Part>], random: &mut ChaCha8Rng) -> Option<(f64, f64)> {
    if strata.iter().all(|clusters| clusters.len() < 2) {
        return None;
    }
    // A resample that has only clusters without a value gives no ratio.
    let mut ratios: Vec<f64> = (0..RESAMPLES)
        .filter_map(|_| {
            let drawn: Vec<&Part> = strata
                .iter()
                .flat_map(|clusters| clusters.iter().map(move |_| clusters))
                .map(|clusters| &clusters[below(clusters.len(), random)])
                .collect();
            ratio(drawn.into_iter())
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let last = ratios.len().checked_sub(1)?;
    let tail = (1.0 - CONFIDENCE) / 2.0;
    let at = |share: f64| ratios[(last as f64 * share).round() as usize];
    Some((at(tail), at(1.0 - tail)))
}

/// A random number below `count`, by multiplication. It deviates from uniform by less than count / 2^64.
fn below(count: usize, random: &mut ChaCha8Rng) -> usize {
    ((u128::from(random.next_u64()) * count as u128) >> 64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use posecut_stage::random;

    fn runs(values: &[f64]) -> Vec<Part> {
        values.iter().map(|&above| Part { above, below: 1.0 }).collect()
    }

    #[test]
    fn an_interval_of_symmetric_clusters_contains_the_mean_and_is_symmetric() {
        let clusters = runs(&(-10..=10).map(f64::from).collect::<Vec<_>>());
        let (low, high) = interval(std::slice::from_ref(&clusters), &mut random(1, "test")).unwrap();
        assert_eq!(ratio(clusters.iter()), Some(0.0));
        // The standard error of the mean is 6.06 / sqrt(21) = 1.32.
        assert!((low + 2.6).abs() < 0.35 && (high - 2.6).abs() < 0.35, "{low} {high}");
    }

    #[test]
    fn seeds_of_one_session_do_not_narrow_an_interval() {
        // Four sessions, each with the same value on ten seeds: four independent values, not forty.
        let few = runs(&[1.0, 2.0, 3.0, 4.0]);
        let many: Vec<Part> = few.iter().map(|part| Part { above: 10.0 * part.above, below: 10.0 }).collect();
        assert_eq!(interval(&[few], &mut random(1, "test")), interval(&[many], &mut random(1, "test")));
    }

    #[test]
    fn one_cluster_a_family_has_no_interval() {
        let strata = [runs(&[1.0]), runs(&[5.0])];
        assert_eq!(interval(&strata, &mut random(1, "test")), None);
        assert_eq!(interval(&[], &mut random(1, "test")), None);
    }
}

//! How well a score separates true from false, and how well a probability is calibrated.

/// A score and whether it is of something true.
pub(super) type Scored = (f64, bool);

/// The area under the ROC curve: the probability that a true one has a higher score than a false one; equal scores count half.
/// O(n log n).
pub(super) fn area(scored: &[Scored]) -> f64 {
    let mut ordered = scored.to_vec();
    ordered.sort_by(|one, other| one.0.total_cmp(&other.0));
    let (mut below, mut won) = (0.0, 0.0);
    for tied in ordered.chunk_by(|one, other| one.0 == other.0) {
        let right = tied.iter().filter(|(_, right)| *right).count() as f64;
        let wrong = tied.len() as f64 - right;
        won += right * (below + 0.5 * wrong);
        below += wrong;
    }
    let right = scored.len() as f64 - below;
    won / (right * below)
}

/// The precision of the highest threshold that keeps all true ones.
pub(super) fn precision_at_full_recall(scored: &[Scored]) -> f64 {
    let right = scored.iter().filter(|(_, right)| *right);
    let least = right.clone().map(|(score, _)| *score).fold(f64::INFINITY, f64::min);
    right.count() as f64 / scored.iter().filter(|(score, _)| *score >= least).count() as f64
}

/// The recall of the lowest threshold that keeps no false one.
pub(super) fn recall_at_full_precision(scored: &[Scored]) -> f64 {
    let wrong = scored.iter().filter(|(_, right)| !right).map(|(score, _)| *score);
    let most = wrong.fold(f64::NEG_INFINITY, f64::max);
    let right: Vec<f64> = scored.iter().filter(|(_, right)| *right).map(|(score, _)| *score).collect();
    right.iter().filter(|score| **score > most).count() as f64 / right.len() as f64
}

/// The bins of a table of calibration end here; the last includes 1.
pub(super) const ENDS: [f64; 7] = [0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0];

/// What is in a bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Bin {
    pub(super) count: usize,
    /// The mean of the probabilities.
    pub(super) stated: f64,
    /// The share of true ones.
    pub(super) found: f64,
}

/// The bins of probabilities.
pub(super) fn bins(scored: &[Scored]) -> Vec<Bin> {
    let mut bins = vec![Bin::default(); ENDS.len()];
    for (probability, right) in scored {
        let at = ENDS.iter().position(|end| probability < end).unwrap_or(ENDS.len() - 1);
        bins[at].count += 1;
        bins[at].stated += probability;
        bins[at].found += f64::from(u8::from(*right));
    }
    for bin in bins.iter_mut().filter(|bin| bin.count > 0) {
        bin.stated /= bin.count as f64;
        bin.found /= bin.count as f64;
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_is_the_share_of_pairs_in_order() {
        // Of six pairs, the right one is higher in four and equal in one.
        let scored = [(0.9, true), (0.5, true), (0.1, false), (0.5, false), (0.7, false)];
        assert!((area(&scored) - 4.5 / 6.0).abs() < 1e-12);
        assert_eq!(area(&[(1.0, true), (0.0, false)]), 1.0);
        assert_eq!(area(&[(1.0, false), (0.0, true)]), 0.0);
    }

    #[test]
    fn thresholds_keep_all_true_or_no_false_ones() {
        let scored = [(0.9, true), (0.8, true), (0.7, false), (0.4, true), (0.2, false)];
        assert_eq!(precision_at_full_recall(&scored), 0.75);
        assert!((recall_at_full_precision(&scored) - 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn a_bin_has_means_of_what_is_in_it() {
        let bins = bins(&[(0.32, true), (0.34, false), (1.0, true), (0.3, true)]);
        assert_eq!(bins[3].count, 3);
        assert!((bins[3].stated - 0.32).abs() < 1e-12 && (bins[3].found - 2.0 / 3.0).abs() < 1e-12);
        assert_eq!(bins[6], Bin { count: 1, stated: 1.0, found: 1.0 });
        assert_eq!(bins[0], Bin::default());
    }
}

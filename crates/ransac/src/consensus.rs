//! The largest consensus set of random minimal sets.

use rand::Rng;
use rand::seq::index;
use rayon::prelude::*;

/// How long to search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Candidates in a minimal set, at least 1.
    pub set_size: usize,
    /// Probability with which at least one set contains only inliers, in (0, 1).
    pub confidence: f64,
    /// The most sets to draw.
    pub most_trials: u64,
}

/// The candidates that agree with the best set.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Consensus {
    /// The set that was drawn, ascending.
    pub set: Vec<usize>,
    /// All candidates that agree with every member of the set, the set included, ascending.
    pub members: Vec<usize>,
    /// Sets drawn.
    pub trials: u64,
    /// Whether the confidence was reached before the limit of trials.
    pub confident: bool,
}

/// Draws sets of `set_size` from `count` candidates, and returns the largest set of candidates that agree with all members
/// of one drawn set; among equals, the first drawn. A set whose members disagree has no votes.
///
/// The search ends after k trials, when the probability that no set was free of outliers is at most `1 - confidence`:
///
/// ```text
/// k = log(1 - confidence) / log(1 - w^set_size)           (Fischler and Bolles, section II.B)
/// ```
///
/// Here w is the share of inliers, estimated by the largest consensus set so far. `agree` must be symmetric. Every trial
/// costs `count * set_size` tests. The result depends on the random numbers alone, not on threads.
pub fn largest_consensus(
    count: usize,
    search: &Search,
    random: &mut impl Rng,
    agree: impl Fn(usize, usize) -> bool + Sync,
) -> Consensus {
    let mut best = Consensus::default();
    let size = search.set_size.max(1).min(count);
    if size == 0 {
        return Consensus { confident: true, ..best };
    }
    let mut needed = f64::INFINITY;
    while best.trials < search.most_trials && (best.trials as f64) < needed {
        best.trials += 1;
        let mut set = index::sample(random, count, size).into_vec();
        set.sort_unstable();
        let sound = set.iter().enumerate().all(|(place, &a)| set[place + 1..].iter().all(|&b| agree(a, b)));
        if !sound {
            continue;
        }
        let members: Vec<usize> = (0..count)
            .into_par_iter()
            .with_min_len(64)
            .filter(|&other| set.iter().all(|&member| member == other || agree(member, other)))
            .collect();
        if members.len() > best.members.len() {
            needed = trials_needed(members.len() as f64 / count as f64, size, search.confidence);
            best = Consensus { set, members, ..best };
        }
    }
    best.confident = best.trials as f64 >= needed;
    best
}

/// The number of trials after which one set contained only inliers, with the given confidence.
fn trials_needed(share: f64, size: usize, confidence: f64) -> f64 {
    let good_set = share.powi(i32::try_from(size).unwrap_or(i32::MAX));
    if good_set >= 1.0 {
        return 1.0;
    }
    // Uses ln_1p for ln(1 - x), because 1 minus a share near zero must not round to 1.
    ((1.0 - confidence).ln() / (-good_set).ln_1p()).ceil().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use posecut_stage::random;
    use proptest::prelude::*;

    const SEARCH: Search = Search { set_size: 2, confidence: 0.999, most_trials: 100_000 };

    #[test]
    fn trials_are_those_of_the_formula() {
        // Half inliers, sets of 2, 99 %: ln 0.01 / ln 0.75 = 16.008; of 4: 71.36 (usual table: 17 and 72).
        assert_eq!(trials_needed(0.5, 2, 0.99), 17.0);
        assert_eq!(trials_needed(0.5, 4, 0.99), 72.0);
        assert_eq!(trials_needed(1.0, 3, 0.99), 1.0);
        assert!(trials_needed(1e-9, 2, 0.99).is_finite());
    }

    #[test]
    fn no_candidates_have_an_empty_consensus() {
        let consensus = largest_consensus(0, &SEARCH, &mut random(1, "test"), |_, _| true);
        assert!(consensus.members.is_empty() && consensus.confident && consensus.trials == 0);
    }

    #[test]
    fn the_limit_of_trials_is_reported() {
        let search = Search { most_trials: 3, ..SEARCH };
        let consensus = largest_consensus(100, &search, &mut random(1, "test"), |_, _| false);
        assert_eq!((consensus.trials, consensus.confident, consensus.members.len()), (3, false, 0));
    }

    proptest! {
        #[test]
        fn the_planted_inliers_are_found_and_agree_with_the_set(
            count in 4_usize..60, share in 0.2_f64..1.0, seed in 0_u64..1000,
        ) {
            // Inliers agree with each other, outliers with none: any consistent set gives all inliers.
            let inliers = ((count as f64 * share) as usize).max(2);
            let agree = |a: usize, b: usize| a < inliers && b < inliers;
            let consensus = largest_consensus(count, &SEARCH, &mut random(seed, "test"), agree);
            prop_assert_eq!(&consensus.members, &(0..inliers).collect::<Vec<_>>());
            prop_assert!(consensus.confident);
        }

        #[test]
        fn the_consensus_is_what_agrees_with_its_set(
            count in 1_usize..30, size in 1_usize..4, relation in proptest::collection::vec(any::<bool>(), 900), seed in 0_u64..100,
        ) {
            let agree = |a: usize, b: usize| relation[a.min(b) * 30 + a.max(b)];
            let search = Search { set_size: size, ..SEARCH };
            let consensus = largest_consensus(count, &Search { most_trials: 200, ..search }, &mut random(seed, "test"), agree);
            let votes: Vec<usize> = (0..count)
                .filter(|&one| consensus.set.iter().all(|&member| one == member || agree(one, member)))
                .collect();
            if !consensus.set.is_empty() {
                prop_assert_eq!(&consensus.members, &votes);
            }
            // All minimal sets of one are drawn sooner or later; the result is then the largest star.
            if size == 1 && consensus.trials == 200 {
                let star = |a: usize| (0..count).filter(|&b| a == b || agree(a, b)).count();
                prop_assert_eq!(consensus.members.len(), (0..count).map(star).max().unwrap());
            }
        }
    }
}

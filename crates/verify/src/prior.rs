//! The share of correct candidates where the map is uncertain.
//!
//! Correct candidates mostly have company, and the map is precise where they are. Few candidates far from all others are
//! correct, while incorrect ones are everywhere. The share of correct ones in the whole graph would accept most lone mistakes
//! that happen to fit.

use crate::evidence::CLIP;

/// Width of a step in the evidence that the map could give at most, nats, and the number of steps. Above them, the share of
/// the whole graph applies.
const STEP: f64 = 2.0;
const STEPS: usize = 8;
/// Correct and wrong candidates added to those counted, so that no share becomes certain.
const UNSEEN: [f64; 2] = [0.5, 1.0];
/// Rounds of expectation maximisation.
const ROUNDS: usize = 50;

/// Prior odds that a candidate is correct, by the evidence that the map could give at most.
pub(crate) struct Prior {
    whole: f64,
    steps: [f64; STEPS],
}

impl Prior {
    /// Estimates the odds from the log-likelihood ratio of each candidate, the ratio that it would have without any error,
    /// and the odds in the whole graph. A step also counts the candidates of all lower steps, and its odds are at most those
    /// of the next, because evidence near zero does not determine a share.
    pub(crate) fn of(ratio: &[Option<f64>], most: &[Option<f64>], whole: f64) -> Self {
        let mut found: [Vec<f64>; STEPS] = Default::default();
        for (ratio, most) in ratio.iter().zip(most).filter_map(|(ratio, most)| ratio.zip(*most)) {
            for step in found.iter_mut().skip(step(most)) {
                step.push(ratio);
            }
        }
        let mut steps = [whole; STEPS];
        let mut least = whole;
        for (odds, ratios) in steps.iter_mut().zip(&found).rev() {
            if !ratios.is_empty() {
                least = least.min(odds_among(ratios));
            }
            *odds = least;
        }
        Self { whole, steps }
    }

    /// The odds for `most`, the log-likelihood ratio without any error, where there is one.
    pub(crate) fn odds(&self, most: Option<f64>) -> f64 {
        most.and_then(|most| self.steps.get(step(most))).copied().unwrap_or(self.whole)
    }
}

fn step(most: f64) -> usize {
    (most.max(0.0) / STEP) as usize
}

/// The odds that a candidate among these is correct, by their log-likelihood ratios.
pub(crate) fn odds_among(ratios: &[f64]) -> f64 {
    let likelihoods: Vec<f64> = ratios.iter().map(|ratio| ratio.clamp(-CLIP, CLIP).exp()).collect();
    let [correct, wrong] = UNSEEN;
    let mut share = 0.5;
    for _ in 0..ROUNDS {
        let among: f64 = likelihoods
            .iter()
            .map(|likelihood| share * likelihood / (share * likelihood + 1.0 - share))
            .sum();
        share = (among + correct) / (ratios.len() as f64 + correct + wrong);
    }
    share / (1.0 - share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_that_fits_among_many_that_do_not_is_no_sign_of_correct_ones() {
        let mut ratios = vec![-20.0; 100];
        ratios[7] = 3.0;
        assert!(odds_among(&ratios) < 0.02);
        // Where most candidates fit, most are correct.
        assert!(odds_among(&[4.0; 20]) > 5.0);
        assert!(odds_among(&[12.0]) > 0.9);
    }

    /// Simulated session 2012-02-02: one false edge of 107, far from all others, fitted by chance. It was accepted, because
    /// most edges of the graph are correct.
    #[test]
    fn lone_candidates_have_a_prior_of_their_own() {
        let mut ratio: Vec<_> = (0..300).map(|place| Some(if place < 250 { 20.0 } else { -8.0 })).collect();
        ratio[299] = Some(3.0);
        let most: Vec<_> = (0..300).map(|place| Some(if place < 250 { 25.0 } else { 5.0 })).collect();
        let prior = Prior::of(&ratio, &most, 5.0);
        assert!(prior.odds(Some(25.0)) == 5.0 && prior.odds(None) == 5.0);
        assert!(prior.odds(Some(5.0)) < 0.05);
        // The odds are no higher where the map is even less certain.
        assert!(prior.odds(Some(1.0)) <= prior.odds(Some(5.0)));
    }
}

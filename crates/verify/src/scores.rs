//! The scores that a front end gives its candidates, on any scale.
//!
//! They weigh what they are worth in the graph: the more often candidates with a high score turn out to be correct, the higher the
//! prior odds of the next one. Scores without information change nothing.

use posecut_graph::PoseGraph;

use crate::evidence::CLIP;
use crate::ingredients::Ingredient;
use crate::model::{Model, Motion};

/// Most classes of scores, and the fewest candidates of a class.
const CLASSES: usize = 10;
const FEWEST: usize = 20;
/// Candidates of the average share that are added to each class, so that no class becomes certain.
const UNSEEN: f64 = 4.0;
/// Largest log-likelihood ratio of a score, nats.
const MOST: f64 = 3.0;

/// Classes of candidates, from the lowest to the highest scores.
pub(crate) struct Scores {
    /// The class of each candidate that has a score.
    class: Vec<Option<usize>>,
    /// The number of classes.
    count: usize,
}

impl Scores {
    pub(crate) fn of<G: Motion<DOF>, const DOF: usize>(graph: &PoseGraph, model: &Model<G, DOF>) -> Self {
        let without = model.without(Ingredient::Score);
        let score = |closure: usize| graph.edges[model.closures[closure].candidate.edge].score;
        let scores = (0..model.closures.len()).map(|closure| score(closure).filter(|_| !without));
        Self::classes(&scores.collect::<Vec<_>>())
    }

    /// Classes of about equal size. Equal scores are in one class.
    fn classes(scores: &[Option<f64>]) -> Self {
        let mut order: Vec<(f64, usize)> =
            scores.iter().enumerate().filter_map(|(candidate, score)| Some(((*score)?, candidate))).collect();
        order.sort_by(|one, other| one.0.total_cmp(&other.0).then(one.1.cmp(&other.1)));
        let size = order.len().div_ceil(CLASSES).max(FEWEST);
        let mut class = vec![None; scores.len()];
        let (mut count, mut members, mut last) = (0, 0, None);
        for (score, candidate) in order {
            if members >= size && last != Some(score) {
                (count, members) = (count + 1, 0);
            }
            (members, last) = (members + 1, Some(score));
            class[candidate] = Some(count);
        }
        Self { class, count: count + 1 }
    }

    /// The log-likelihood ratio of each candidate's score, correct against wrong, learnt from the evidence of all candidates
    /// (log-likelihood ratios) and the prior odds. It does not fall with the score.
    pub(crate) fn ratios(&self, evidence: &[Option<f64>], odds: f64) -> Vec<f64> {
        let mut classes = vec![(0.0, 0.0); self.count];
        for (class, ratio) in self.class.iter().zip(evidence).filter_map(|(class, ratio)| class.zip(*ratio)) {
            classes[class].0 += 1.0 / (1.0 + (-ratio.clamp(-CLIP, CLIP)).exp() / odds);
            classes[class].1 += 1.0;
        }
        let (correct, all) = classes.iter().fold((0.0, 0.0), |sum, own| (sum.0 + own.0, sum.1 + own.1));
        if all == 0.0 {
            return vec![0.0; evidence.len()];
        }
        let average = correct / all;
        let shares =
            classes.iter().map(|(correct, all)| (correct + UNSEEN * average, all + UNSEEN)).collect();
        let shares = rising(shares);
        // Scores that do not separate the classes have no weight at all, not one of rounding errors.
        if shares.first() == shares.last() {
            return vec![0.0; evidence.len()];
        }
        let logit = |share: f64| (share / (1.0 - share)).ln();
        let ratio = |share: f64| (logit(share) - logit(average)).clamp(-MOST, MOST);
        let learnt: Vec<f64> = shares.into_iter().map(ratio).collect();
        self.class.iter().map(|class| class.map_or(0.0, |class| learnt[class])).collect()
    }
}

/// The non-decreasing sequence of shares that is nearest to these parts of wholes: neighbours in the wrong order are pooled
/// (Ayer et al., Annals of Mathematical Statistics 26, 1955).
fn rising(parts: Vec<(f64, f64)>) -> Vec<f64> {
    let mut blocks: Vec<(f64, f64, usize)> = Vec::with_capacity(parts.len());
    for (part, whole) in parts {
        let mut block = (part, whole, 1);
        while let Some(&(last, all, length)) = blocks.last()
            && last * block.1 >= block.0 * all
        {
            blocks.pop();
            block = (last + block.0, all + block.1, length + block.2);
        }
        blocks.push(block);
    }
    blocks.into_iter().flat_map(|(part, whole, length)| std::iter::repeat_n(part / whole, length)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_in_the_wrong_order_are_pooled() {
        let found = rising(vec![(1.0, 10.0), (4.0, 10.0), (2.0, 10.0), (9.0, 10.0)]);
        assert_eq!(found, [0.1, 0.3, 0.3, 0.9]);
        assert_eq!(rising(vec![(3.0, 4.0), (1.0, 4.0)]), [0.5, 0.5]);
    }

    #[test]
    fn equal_scores_share_a_class_and_few_scores_tell_nothing() {
        let values: Vec<_> = (0..100).map(|place| Some(f64::from(place / 50))).collect();
        let scores = Scores::classes(&values);
        assert!(scores.count == 2 && scores.class[..50].iter().all(|class| *class == Some(0)));
        let few = Scores::classes(&[Some(1.0), None, Some(3.0)]);
        assert_eq!((few.count, few.class.as_slice()), (1, [Some(0), None, Some(0)].as_slice()));
        let ratios = few.ratios(&[Some(20.0), Some(20.0), Some(-20.0)], 1.0);
        assert!(ratios[0].abs() < 0.2 && ratios[1] == 0.0, "{ratios:?}");
    }

    #[test]
    fn scores_without_any_evidence_tell_nothing() {
        let scores = Scores::classes(&[Some(1.0), Some(2.0), None]);
        assert_eq!(scores.ratios(&[None, None, Some(3.0)], 1.0), [0.0; 3]);
    }

    /// A score that separates correct from wrong candidates is learnt; one without information, or with the opposite meaning,
    /// has no weight.
    #[test]
    fn a_score_weighs_what_it_is_worth() {
        let correct = |place: usize| place.is_multiple_of(2);
        let evidence: Vec<_> =
            (0..200).map(|place| Some(if correct(place) { 15.0 } else { -15.0 })).collect();
        let by = |score: fn(usize) -> f64| {
            let scores: Vec<_> = (0..200).map(|place| Some(score(place))).collect();
            Scores::classes(&scores).ratios(&evidence, 1.0)
        };
        let telling = by(|place| (place % 2) as f64 * -50.0 + (place / 4) as f64 * 0.1);
        assert!(telling[0] > 2.0 && telling[1] < -2.0, "{} {}", telling[0], telling[1]);
        for empty in [|place: usize| (place / 2) as f64, |place: usize| (place % 2) as f64] {
            assert!(by(empty).iter().all(|ratio| ratio.abs() < 0.2), "{:?}", by(empty));
        }
    }
}

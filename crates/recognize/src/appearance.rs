//! The probability that two keyframes see the same place, from the words of both: FAB-MAP (Cummins and Newman, *FAB-MAP:
//! probabilistic localization and mapping in the space of appearance*, IJRR 27(6), 2008), arranged as in *Appearance-only SLAM at large
//! scale with FAB-MAP 2.0* (IJRR 30(9), 2011), so that a place costs only its own words.
//!
//! A place is a set of things that exist there; a detector sees a thing that exists with some probability, and one that does not with
//! another. Seeing a rare word twice says much, seeing a common one little, and words that go together count once, by the tree of
//! words. The hypothesis that the keyframe sees a place that no other has seen is among the hypotheses.

use crate::Words;
use crate::chow_liu::Tree;

/// How a detector errs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detector {
    /// The probability that a thing that exists is seen.
    pub seen: f64,
    /// The probability that one that does not exist is.
    pub imagined: f64,
}

/// The model of a set of keyframes.
pub struct Appearance<'a> {
    words: &'a Words,
    tree: Tree,
    detector: Detector,
    /// The probability that a thing exists anywhere.
    exists: Vec<f64>,
    /// Keyframes that stand for a place never seen before.
    average: Vec<usize>,
}

/// What one keyframe's words say about places.
pub struct Evidence<'m> {
    model: &'m Appearance<'m>,
    /// For each word, the log-likelihood of this observation at a place where it was seen, against one where it was not.
    gain: Vec<f64>,
    /// The log of the mean likelihood at an average place, against one without words.
    average: f64,
}

/// Keyframes from which the tree is learnt, and those that stand for a new place.
const LEARNT: usize = 2000;
const AVERAGED: usize = 300;

impl<'a> Appearance<'a> {
    /// Learns from the words of all keyframes, which need no labels. O(sum of squared bags, logarithmic factor).
    pub fn new(words: &'a Words, detector: Detector) -> Self {
        let tree = Tree::new(words, &words.sample(LEARNT));
        let Detector { seen, imagined } = detector;
        // p(z) = p(z|e) p(e) + p(z|not e) (1 - p(e)).
        let exists = tree
            .marginal
            .iter()
            .map(|marginal| {
                ((marginal - imagined * marginal) / (seen - imagined * marginal)).clamp(1e-6, 0.99)
            })
            .collect();
        Self { words, tree, detector, exists, average: words.sample(AVERAGED) }
    }

    /// What a keyframe's words say. O(vocabulary + words of the average places).
    pub fn evidence(&'a self, keyframe: usize, elsewhere: impl Fn(usize) -> bool) -> Evidence<'a> {
        let bag = &self.words.bags[keyframe];
        let mut seen = vec![false; self.words.vocabulary];
        for &word in bag {
            seen[word] = true;
        }
        let gain: Vec<f64> = (0..seen.len())
            .map(|word| {
                let likelihood = |at_place: bool| self.likelihood(word, &seen, at_place);
                likelihood(true).ln() - likelihood(false).ln()
            })
            .collect();
        let mut evidence = Evidence { model: self, gain, average: 0.0 };
        let others: Vec<f64> = self
            .average
            .iter()
            .filter(|other| elsewhere(**other))
            .map(|&other| evidence.log_likelihood(other))
            .collect();
        evidence.average = log_mean(&others);
        evidence
    }

    /// `p(z_q | z_parent, L)` of a word in an observation, at a place where it was seen once, or was not: the sum over `e_q`.
    fn likelihood(&self, word: usize, seen: &[bool], at_place: bool) -> f64 {
        let now = seen[word];
        let given = match self.tree.parent[word] {
            Some(parent) => self.tree.given[word][usize::from(seen[parent])],
            None => self.tree.marginal[word],
        };
        let exists = self.exists_at(word, at_place);
        exists * self.observed(word, now, true, given)
            + (1.0 - exists) * self.observed(word, now, false, given)
    }

    /// `p(e_q | L)` after one observation of the place, by Bayes' rule.
    fn exists_at(&self, word: usize, seen: bool) -> f64 {
        let prior = self.exists[word];
        let with = self.detected(word, seen, true) * prior;
        with / (with + self.detected(word, seen, false) * (1.0 - prior))
    }

    /// `p(z_q | e_q, z_parent)`, made of the detector and the tree: the odds of `z_q` given its parent, divided by its odds alone, times the
    /// detector's odds.
    fn observed(&self, word: usize, now: bool, exists: bool, given: f64) -> f64 {
        let either = |probability: f64, now: bool| if now { probability } else { 1.0 - probability };
        let marginal = self.tree.marginal[word];
        let against = either(marginal, now) * self.detected(word, !now, exists) * either(given, !now);
        let favour = either(marginal, !now) * self.detected(word, now, exists) * either(given, now);
        favour / (favour + against)
    }

    /// `p(z | e)` of the detector.
    fn detected(&self, word: usize, seen: bool, exists: bool) -> f64 {
        let probability =
            if exists { self.detector.seen } else { self.detector.imagined * self.tree.marginal[word] };
        if seen { probability } else { 1.0 - probability }
    }
}

impl Evidence<'_> {
    /// The log-likelihood of the observation at a keyframe's place, against a place without words. O(words of the place).
    fn log_likelihood(&self, place: usize) -> f64 {
        self.model.words.bags[place].iter().map(|&word| self.gain[word]).sum()
    }

    /// The log-likelihood ratio of a keyframe's place against a new place, nats.
    pub fn ratio(&self, place: usize) -> f64 {
        self.log_likelihood(place) - self.average
    }
}

/// `ln(mean(exp(values)))`.
fn log_mean(values: &[f64]) -> f64 {
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if largest == f64::NEG_INFINITY {
        return 0.0;
    }
    let sum: f64 = values.iter().map(|value| (value - largest).exp()).sum();
    largest + (sum / values.len() as f64).ln()
}

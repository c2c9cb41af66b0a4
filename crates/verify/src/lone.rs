//! Groups of edges on a short stretch that alone join two components.
//!
//! Nothing else is a witness for such a group, and edges from one mistaken place agree with each other as well as correct ones do. But
//! elsewhere the map judges groups that are as short: how often these are wrong says how far to trust the lone one.

use crate::ingredients::Ingredient;
use crate::islands::Hypothesis;
use crate::judge::joined;
use crate::model::Motion;
use crate::rounds::Rounds;

/// Probability below which a lone hypothesis joins nothing.
pub(crate) const DOUBTFUL: f64 = 0.5;

impl<G: Motion<DOF>, const DOF: usize> Rounds<'_, G, DOF> {
    /// Whether a hypothesis is short, and no other one between the same chains agrees with it.
    pub(crate) fn is_lone(&self, hypothesis: &Hypothesis) -> bool {
        let agrees = |other: &Hypothesis| self.is_mostly(hypothesis, other, |weight| weight > 0.0);
        self.is_short(hypothesis) && !self.others_between(hypothesis).any(agrees)
    }

    /// The probability that a lone hypothesis is correct: the share of those like it that the map holds, by Laplace's rule of
    /// succession. Like it are short hypotheses with comparable evidence that the map judges. It counts itself among those that the map
    /// holds, because most are correct in most graphs.
    pub(crate) fn share_of_correct(&self, hypothesis: &Hypothesis) -> f64 {
        succession(self.like(hypothesis))
    }

    /// Of the hypotheses like a lone one, how many the map holds, with this one, and how many it does not hold.
    fn like(&self, hypothesis: &Hypothesis) -> (usize, usize) {
        let within = self.within();
        let is_judged =
            |other: &Hypothesis| within(other) && other.members != hypothesis.members && self.is_short(other);
        let (held, others) = self.held_and_others(hypothesis, is_judged);
        (held + 1, others)
    }

    /// For each closure of a lone hypothesis that alone joins, or would join, two components, the probability that the hypothesis is
    /// correct. Where the map finds none like it false, nothing gives reason to doubt it.
    pub(crate) fn credibility(&self) -> Vec<Option<f64>> {
        let mut found = vec![None; self.accepted.len()];
        if self.model.without(Ingredient::Rivals) {
            return found;
        }
        for hypothesis in self.hypotheses.iter().filter(|hypothesis| hypothesis.is_strong()) {
            if self.alone_joins(hypothesis) && self.is_lone(hypothesis) && !self.has_rival(hypothesis) {
                let like = self.like(hypothesis);
                let share = (like.1 > 0).then(|| succession(like));
                hypothesis.members.iter().for_each(|&member| found[member] = share);
            }
        }
        found
    }

    /// Whether no other accepted closures join the chains of a hypothesis.
    fn alone_joins(&self, hypothesis: &Hypothesis) -> bool {
        let mut others = self.accepted.clone();
        hypothesis.members.iter().for_each(|&member| others[member] = false);
        let span = self.model.span(hypothesis.members[0]);
        span.a != span.b && !joined(self.model, |closure| others[closure]).0.equiv(span.a, span.b)
    }
}

/// The probability that the next one is held, by Laplace's rule of succession.
fn succession((held, others): (usize, usize)) -> f64 {
    (held + 1) as f64 / (held + others + 2) as f64
}

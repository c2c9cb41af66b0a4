//! Groups of edges on a short stretch that alone join two components.
//!
//! Nothing else is a witness for such a group, and edges from one mistaken place agree with each other as well as correct ones do. But
//! elsewhere the map judges groups that are as short: how often these are wrong says how far to trust the lone one.

use crate::ingredients::Ingredient;
use crate::islands::Hypothesis;
use crate::judge::joined;
use crate::model::Motion;
use crate::rivals::COMPARABLE;
use crate::rounds::Rounds;

impl<G: Motion<DOF>, const DOF: usize> Rounds<'_, G, DOF> {
    /// Whether a hypothesis is short, and no other one between the same chains agrees with it.
    pub(crate) fn is_lone(&self, hypothesis: &Hypothesis) -> bool {
        let group = |hypothesis: &Hypothesis| self.model.group(hypothesis.members[0]);
        let others = || {
            self.hypotheses
                .iter()
                .filter(|other| group(other) == group(hypothesis) && other.members != hypothesis.members)
        };
        self.is_short(hypothesis)
            && !others().any(|other| self.is_mostly(hypothesis, other, |weight| weight > 0.0))
    }

    /// Whether, of the short hypotheses with comparable evidence that the map judges, it holds fewer than it does not hold, even with
    /// this one among those that it holds.
    pub(crate) fn is_doubtful(&self, hypothesis: &Hypothesis) -> bool {
        let (held, others) = self.like(hypothesis);
        held < others
    }

    /// Of the other short hypotheses with comparable evidence that the map judges, how many it holds, with this one, and how many it
    /// does not hold. This one counts because most are correct in most graphs.
    fn like(&self, hypothesis: &Hypothesis) -> (usize, usize) {
        let part = self.parts.clone().into_labeling();
        let is_judged = |other: &&Hypothesis| {
            let span = self.model.span(other.members[0]);
            part[span.a] == part[span.b]
                && other.evidence >= COMPARABLE * hypothesis.evidence
                && other.members != hypothesis.members
                && self.is_short(other)
        };
        let judged = self.hypotheses.iter().filter(is_judged);
        let (held, others): (Vec<_>, Vec<_>) = judged.partition(|other| self.has_half_of(other));
        (held.len() + 1, others.len())
    }

    /// The probability that a lone hypothesis is correct: the share of those like it that the map holds, by Laplace's rule of
    /// succession. For each closure of one that alone joins, or would join, two components. Where the map finds none like it false,
    /// nothing gives reason to doubt it.
    pub(crate) fn credibility(&self) -> Vec<Option<f64>> {
        let mut found = vec![None; self.accepted.len()];
        if self.model.without(Ingredient::Rivals) {
            return found;
        }
        for hypothesis in self.hypotheses.iter().filter(|hypothesis| hypothesis.is_strong()) {
            if self.is_short(hypothesis)
                && self.alone_joins(hypothesis)
                && self.is_lone(hypothesis)
                && !self.has_rival(hypothesis)
            {
                let (held, others) = self.like(hypothesis);
                let share = (others > 0).then(|| (held + 1) as f64 / (held + others + 2) as f64);
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

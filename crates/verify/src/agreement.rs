//! Whether the map agrees with whole hypotheses.

use crate::islands::Hypothesis;
use crate::model::Motion;
use crate::rivals::COMPARABLE;
use crate::rounds::{CONTRADICTED, DOUBT, Rounds};

impl<G: Motion<DOF>, const DOF: usize> Rounds<'_, G, DOF> {
    /// The prior odds against a hypothesis: among those with comparable evidence, the number that the map does not hold for
    /// each one that it holds. Never below one, because a group that agrees with itself may always consist of false edges.
    fn odds_against(&self, hypothesis: &Hypothesis) -> f64 {
        let (held, others) = self.held_and_others(hypothesis, |_| true);
        ((others + 1) as f64 / (held + 1) as f64).max(1.0)
    }

    /// Of the hypotheses with comparable evidence for which a condition holds, the number that the map holds and that it does not hold.
    pub(crate) fn held_and_others(
        &self,
        hypothesis: &Hypothesis,
        holds: impl Fn(&Hypothesis) -> bool,
    ) -> (usize, usize) {
        let comparable = self
            .hypotheses
            .iter()
            .filter(|other| other.evidence >= COMPARABLE * hypothesis.evidence && holds(other));
        let (held, others): (Vec<_>, Vec<_>) = comparable.partition(|other| self.has_half_of(other));
        (held.len(), others.len())
    }

    /// Whether each hypothesis lies within one component of the graph.
    pub(crate) fn within(&self) -> impl Fn(&Hypothesis) -> bool {
        let part = self.parts.clone().into_labeling();
        move |hypothesis| {
            let span = self.model.span(hypothesis.members[0]);
            part[span.a] == part[span.b]
        }
    }

    /// The numbers of hypotheses within components of the graph that the map does not hold.
    pub(crate) fn open(&self) -> Vec<usize> {
        let within = self.within();
        let is_open = |hypothesis: &Hypothesis| within(hypothesis) && !self.has_half_of(hypothesis);
        (0..self.hypotheses.len()).filter(|&number| is_open(&self.hypotheses[number])).collect()
    }

    /// Whether the map holds at least half of a hypothesis.
    fn has_half_of(&self, hypothesis: &Hypothesis) -> bool {
        let accepted = hypothesis.members.iter().filter(|&&member| self.accepted[member]).count();
        2 * accepted >= hypothesis.members.len()
    }

    /// Evidence of the map above which little doubt of a hypothesis remains.
    fn enough(&self, hypothesis: &Hypothesis) -> f64 {
        (self.odds_against(hypothesis) * (1.0 - DOUBT) / DOUBT).ln()
    }

    /// Whether the evidence of a map leaves little doubt of most members of a hypothesis.
    pub(crate) fn agrees(&self, hypothesis: &Hypothesis, evidence: impl Fn(usize) -> Option<f64>) -> bool {
        let enough = self.enough(hypothesis);
        hypothesis.is_mostly(|member| evidence(member).is_some_and(|evidence| evidence > enough))
    }

    /// Whether the map is too uncertain to support most members of a hypothesis, even without any error, and does not
    /// contradict them.
    pub(crate) fn unplaced(&self, hypothesis: &Hypothesis) -> bool {
        let enough = self.enough(hypothesis);
        hypothesis.is_mostly(|member| {
            self.most[member].is_some_and(|most| most <= enough)
                && self.ratio[member].is_some_and(|ratio| ratio > CONTRADICTED)
        })
    }
}

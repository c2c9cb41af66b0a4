//! Rivals: other ways to join two chains, with comparable evidence.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::islands::Hypothesis;
use crate::judge::{Judged, joined};
use crate::lone::DOUBTFUL;
use crate::model::{Model, Motion};
use crate::rounds::{CONTRADICTED, Rounds};

/// Smallest evidence of a rival, as a share of that of the accepted edges between the same chains.
pub(crate) const COMPARABLE: f64 = 0.5;

/// Longest stretch of a chain from which one mistaken place may take all edges of a group, as a share of the chain.
const SHORT: f64 = 0.1;

/// Another way to join two chains.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rival {
    /// Its number, as in the findings.
    pub hypothesis: usize,
    /// How many landmark edges it has.
    pub edges: usize,
    /// Its evidence, nats.
    pub evidence: f64,
    /// The evidence of the accepted edges between the same chains, nats; 0 if nothing joins these chains.
    pub accepted: f64,
    /// Whether it would join these chains alone, on a short stretch, and the map contradicts more groups like it than it holds.
    pub lone: bool,
}

impl Rival {
    /// Whether nothing joins these chains, because the map cannot tell whether, or which, rivals are correct.
    pub fn is_open(&self) -> bool {
        self.accepted == 0.0
    }
}

/// The rivals of the map, in the order of their numbers. Between chains that nothing joins, the rivals of each other.
pub(crate) fn rivals<G: Motion<DOF>, const DOF: usize>(model: &Model<G, DOF>, judged: &Judged) -> Vec<Rival> {
    let group = |hypothesis: &Hypothesis| model.group(hypothesis.members[0]);
    let part = joined(model, |closure| judged.accepted[closure]).0.into_labeling();
    let (mut held, mut heaviest) = (BTreeMap::new(), BTreeMap::new());
    for hypothesis in judged.hypotheses.iter().filter(|hypothesis| judged.has_member_of(hypothesis)) {
        *held.entry(group(hypothesis)).or_insert(0.0) += hypothesis.evidence;
    }
    for hypothesis in &judged.hypotheses {
        let span = model.span(hypothesis.members[0]);
        if part[span.a] != part[span.b] {
            let most: &mut f64 = heaviest.entry(group(hypothesis)).or_insert(0.0);
            *most = most.max(hypothesis.evidence);
        }
    }
    (1..)
        .zip(judged.others())
        .filter(|(_, other)| !model.same_chain(other.members[0]))
        .filter_map(|(hypothesis, other)| {
            let accepted = held.get(&group(other)).copied();
            let compared = accepted.or_else(|| heaviest.get(&group(other)).copied())?;
            let evidence = other.evidence;
            let (edges, accepted) = (other.members.len(), accepted.unwrap_or(0.0));
            let lone = judged.credibility[other.members[0]].is_some_and(|credibility| credibility < DOUBTFUL);
            let rival = Rival { hypothesis, edges, evidence, accepted, lone };
            (evidence >= COMPARABLE * compared).then_some(rival)
        })
        .collect()
}

impl<G: Motion<DOF>, const DOF: usize> Rounds<'_, G, DOF> {
    /// Whether a hypothesis of one short stretch has a rival: another one joins the same chains, excludes it, and has at least a share of
    /// its evidence. That of hypotheses that agree with it counts for it. Edges between two chains that nothing else joins have only each
    /// other as witnesses, and on a short stretch a group of false edges, from one mistaken place, agrees with itself as well as correct
    /// edges do.
    pub(crate) fn has_rival(&self, hypothesis: &Hypothesis) -> bool {
        if !self.is_short(hypothesis) {
            return false;
        }
        let others = || self.others_between(hypothesis).filter(|other| other.is_strong());
        // Only these can have a share of the whole.
        let comparable = others().filter(|other| other.evidence >= COMPARABLE * hypothesis.evidence);
        let against = comparable
            .filter(|other| self.is_mostly(hypothesis, other, |weight| weight <= CONTRADICTED))
            .map(|other| other.evidence)
            .fold(0.0, f64::max);
        if against == 0.0 {
            return false;
        }
        let evidence = others()
            .filter(|other| self.is_mostly(hypothesis, other, |weight| weight > 0.0))
            .fold(hypothesis.evidence, |sum, other| sum + other.evidence);
        against >= COMPARABLE * evidence
    }

    /// The other hypotheses between the same chains.
    pub(crate) fn others_between(&self, hypothesis: &Hypothesis) -> impl Iterator<Item = &Hypothesis> {
        let group = |hypothesis: &Hypothesis| self.model.group(hypothesis.members[0]);
        let own = group(hypothesis);
        self.hypotheses.iter().filter(move |other| group(other) == own && other.members != hypothesis.members)
    }

    /// Whether the members of a hypothesis lie within a short stretch of both chains.
    pub(crate) fn is_short(&self, hypothesis: &Hypothesis) -> bool {
        let ends: Vec<_> = hypothesis.members.iter().map(|&member| self.model.ends(member)).collect();
        [0, 1].into_iter().all(|side| {
            let places = || ends.iter().map(|end| end[side].1);
            let stretch = places().max().unwrap_or(0) - places().min().unwrap_or(0);
            let whole = self.model.chains.chains[ends[0][side].0].poses.len();
            stretch as f64 <= SHORT * whole as f64
        })
    }

    /// Whether a condition holds for the evidence of most loops through a member of each hypothesis.
    pub(crate) fn is_mostly(
        &self,
        one: &Hypothesis,
        other: &Hypothesis,
        holds: impl Fn(f64) -> bool,
    ) -> bool {
        let others = other.witnesses();
        let pairs = one.witnesses().into_iter().flat_map(|one| others.iter().map(move |&other| (one, other)));
        let weights: Vec<f64> = pairs
            .filter_map(|(one, other)| Some(self.random.evidence(&self.model.pair(one, other))?.weight()))
            .collect();
        2 * weights.iter().filter(|&&weight| holds(weight)).count() > weights.len()
    }
}

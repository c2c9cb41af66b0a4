//! Rounds of map and verdicts.

use std::mem::replace;

use petgraph::unionfind::UnionFind;

use crate::bridges::{Bridge, Seams};
use crate::calibration::Calibration;
use crate::chance::second_moment;
use crate::cut::COST;
use crate::evidence::Evidence;
use crate::ingredients::Ingredient;
use crate::islands::Hypothesis;
use crate::map::Drawing;
use crate::model::{Model, Motion};
use crate::partners::Partners;
use crate::prior::{Prior, odds_among};
use crate::scores::Scores;

/// Most rounds that do not mainly add closures.
const ROUNDS: usize = 12;
/// Most rounds in all. A round mainly adds closures if it accepts this many times as many as the round before.
const ROUNDS_IN_ALL: usize = 60;
const GROWTH: f64 = 1.02;
/// Log-likelihood ratio at which a closure contradicts the map.
pub(crate) const CONTRADICTED: f64 = -3.0;
/// Nats by which two positions are more often near each other by chance than their second moment says: robots stay on roads, and
/// return to them. An edge that alone joins two sessions needs this much more evidence.
const ROADS: f64 = 5.0;
/// Largest probability of being wrong at which a closure is accepted.
pub(crate) const DOUBT: f64 = 0.1;
/// The same limit for a closure whose error is larger than that of 99 % of correct closures.
const UNUSUAL_DOUBT: f64 = 0.01;

/// Whether a local error is too likely, given its odds against a correct closure.
pub(crate) fn is_vague(wrong: f64) -> bool {
    wrong / (1.0 + wrong) > DOUBT
}

/// Everything that rounds need.
pub(crate) struct Rounds<'a, G, const DOF: usize> {
    pub(crate) model: &'a Model<G, DOF>,
    pub(crate) scores: Scores,
    pub(crate) partners: Partners,
    pub(crate) drawing: Drawing<G, DOF>,
    /// Calibration without coherent terms, because the optimiser does not model them.
    pub(crate) random: Calibration,
    pub(crate) threshold: f64,
    pub(crate) hypotheses: Vec<Hypothesis>,
    /// The members of the hypothesis that a user has chosen.
    pub(crate) preferred: Option<&'a [usize]>,
    /// Components of the graph: chains that accepted closures join.
    pub(crate) parts: UnionFind<usize>,
    pub(crate) accepted: Vec<bool>,
    pub(crate) ratio: Vec<Option<f64>>,
    /// Log-likelihood ratio of each closure against chance alone, however large the error.
    pub(crate) chance: Vec<Option<f64>>,
    /// Hypotheses that have already been part of a trial map.
    pub(crate) tried: Vec<bool>,
    /// Whether the error is as small as that of 99 % of correct closures.
    pub(crate) fits: Vec<bool>,
    /// Evidence of each closure from the bridges between its chains; `begun` has only that of bridges between sessions.
    pub(crate) bridged: Vec<Option<Evidence>>,
    pub(crate) begun: Vec<Option<Evidence>>,
    pub(crate) seams: Seams<G, DOF>,
    /// The log-likelihood ratio that each closure would have without any error, where the map predicts it. It is small where
    /// the map is uncertain about the ends of the closure.
    pub(crate) most: Vec<Option<f64>>,
    /// Log-likelihood ratio of each closure, correct against a local error, where there is one.
    pub(crate) local: Vec<Option<f64>>,
    /// Whether to leave out closures that may as well have a local error. This is set only at the end, because such closures
    /// lead to others that may resolve the doubt.
    pub(crate) strict: bool,
    /// Squared distance that 99 % of correct closures stay below.
    pub(crate) usual: f64,
    /// Poses of the last map, to start from if the next map is nearly the same.
    pub(crate) poses: Option<Vec<G>>,
}

impl<G: Motion<DOF>, const DOF: usize> Rounds<'_, G, DOF> {
    /// Runs rounds until nothing changes or two results alternate. Then adds closures that only a bridge supports, and
    /// repeats until there are none. Returns the number of rounds.
    pub(crate) fn all(&mut self, bridges: &[Bridge<G, DOF>]) -> anyhow::Result<usize> {
        let mut number = 0;
        let mut next = self.accepted.clone();
        let mut before = self.ratio.clone();
        if self.model.without(Ingredient::Rounds) {
            self.join(&mut next, true);
            self.accepted = next;
            return Ok(number);
        }
        self.join(&mut next, false);
        loop {
            let mut settling = 0;
            while settling < ROUNDS && number < ROUNDS_IN_ALL {
                let last = replace(&mut self.accepted, next);
                number += 1;
                before.clone_from(&self.ratio);
                next = self.round()?;
                if next == self.accepted || next == last {
                    break;
                }
                let size = |set: &[bool]| set.iter().filter(|member| **member).count() as f64;
                settling += usize::from(size(&next) < GROWTH * size(&self.accepted));
            }
            self.agree(&next, &before);
            next.clone_from(&self.accepted);
            if self.join(&mut next, true) {
                self.poses = None;
                continue;
            }
            if !self.strict && !self.model.without(Ingredient::Local) {
                self.strict = true;
                for (closure, stays) in next.iter_mut().enumerate() {
                    *stays &= self.precise(closure);
                }
                if next != self.accepted {
                    continue;
                }
            }
            let mut placed = self.across(bridges)?;
            placed.extend(self.continued());
            if placed.is_empty() {
                return Ok(number);
            }
            for closure in placed {
                let span = self.model.span(closure);
                self.parts.union(span.a, span.b);
                next[closure] = true;
            }
            self.poses = None;
        }
    }

    /// If rounds alternate, accepts what both accept. A closure that only one of them accepts gets the smaller evidence of
    /// the two.
    fn agree(&mut self, next: &[bool], before: &[Option<f64>]) {
        for closure in 0..next.len() {
            if self.accepted[closure] != next[closure] {
                self.accepted[closure] = false;
                let both = self.ratio[closure].zip(before[closure]);
                self.ratio[closure] = both.map(|(now, before)| now.min(before)).or(self.ratio[closure]);
            }
        }
    }

    /// Closures between components that a bridge supports and that are likely to be correct.
    fn across(&mut self, bridges: &[Bridge<G, DOF>]) -> anyhow::Result<Vec<usize>> {
        let mut bridged = self.parts.clone();
        let edges: Vec<_> = bridges
            .iter()
            .filter(|bridge| bridged.union(bridge.chains[0], bridge.chains[1]))
            .map(|bridge| bridge.edge)
            .collect();
        let asked: Vec<usize> = (0..self.accepted.len())
            .filter(|&closure| {
                let span = self.model.span(closure);
                self.accepted[closure] || bridged.equiv(span.a, span.b) && !self.parts.equiv(span.a, span.b)
            })
            .collect();
        let open: Vec<usize> = asked.iter().copied().filter(|&closure| !self.accepted[closure]).collect();
        if open.is_empty() {
            return Ok(Vec::new());
        }
        let mut map = self.drawing.map(self.model, &self.random, &self.accepted, &edges, None)?;
        map.enough = self.threshold;
        map.apart = Some(second_moment(&map.poses));
        let judged = map.judge(&self.partners, &asked, &open);
        map.finish();
        let found: Vec<_> = asked
            .iter()
            .copied()
            .zip(judged)
            .filter(|(closure, _)| !self.accepted[*closure])
            .filter_map(|(closure, evidence)| Some((closure, self.with_bridge(closure, evidence?))))
            .collect();
        let weights: Vec<f64> = found.iter().map(|(_, evidence)| evidence.weight()).collect();
        // Components that nothing else joins have few correct closures between them.
        let few = (odds_among(&weights) / self.random.odds()).ln().min(0.0);
        for (closure, evidence) in found {
            // A closure that contradicts the usual motion may still be correct: somebody may have carried the robot.
            if evidence.weight() + few > 0.0 {
                self.ratio[closure] = Some(evidence.weight() + few);
                self.fits[closure] = evidence.squared_distance <= self.usual;
                self.local[closure] = Some(evidence.local);
            }
        }
        let mut placed = self.likely(&self.accepted);
        placed.retain(|closure| open.binary_search(closure).is_ok());
        Ok(placed)
    }

    /// Closures that alone join two sessions, where one session begins so soon after the other ended that this cannot be chance.
    fn continued(&mut self) -> Vec<usize> {
        let mut placed = Vec::new();
        for closure in 0..self.accepted.len() {
            let span = self.model.span(closure);
            let Some(evidence) = self.begun[closure].filter(|_| !self.parts.equiv(span.a, span.b)) else {
                continue;
            };
            if evidence.weight() > self.threshold + ROADS && evidence.squared_distance <= self.usual {
                self.ratio[closure] = Some(evidence.weight());
                self.fits[closure] = true;
                self.local[closure] = Some(evidence.local);
                if self.precise(closure) {
                    placed.push(closure);
                }
            }
        }
        placed
    }

    /// Optimises the map of the accepted closures, judges every closure within a component by it, and joins further
    /// components. Returns what is accepted next.
    fn round(&mut self) -> anyhow::Result<Vec<bool>> {
        let part = self.parts.clone().into_labeling();
        let within: Vec<bool> = (0..self.accepted.len())
            .map(|closure| {
                let span = self.model.span(closure);
                part[span.a] == part[span.b]
            })
            .collect();
        let asked: Vec<usize> = (0..within.len()).filter(|&closure| within[closure]).collect();
        let open = self.open();
        let first: Vec<usize> = open.iter().flat_map(|&number| self.hypotheses[number].witnesses()).collect();
        let (poses, judged) = self.draw(&part, &asked, &first)?;
        self.weigh(&asked, judged);
        let mut next = self.held(&within);
        let open = || open.iter().map(|&number| &self.hypotheses[number]);
        for &member in open()
            .filter(|hypothesis| self.agrees(hypothesis, |member| self.ratio[member]))
            .flat_map(|found| &found.members)
        {
            next[member] = true;
        }
        // Where odometry cannot judge closures, only an island's own evidence can place it. The heaviest goes first.
        if self.random.on_prior
            && let Some(unseen) =
                open().find(|hypothesis| hypothesis.is_strong() && self.unplaced(hypothesis))
        {
            for &member in &unseen.members {
                next[member] = true;
            }
        }
        let joined = self.join(&mut next, false);
        // If nothing was joined, the next map is nearly the same: start from this one.
        self.poses = (!joined).then_some(poses);
        Ok(next)
    }

    /// The map of the accepted closures, and its evidence for each closure in `asked`. The map includes the bridges that it
    /// confirms.
    fn draw(
        &mut self,
        part: &[usize],
        asked: &[usize],
        first: &[usize],
    ) -> anyhow::Result<(Vec<G>, Vec<Option<Evidence>>)> {
        let mut start = self.poses.take();
        loop {
            let bridges = &self.seams.confirmed;
            let mut map =
                self.drawing.map(self.model, &self.random, &self.accepted, bridges, start.as_deref())?;
            map.enough = self.threshold;
            let judged = map.judge(&self.partners, asked, first);
            // A round that confirms a bridge must not accept what the bridge contradicts, so judge again with the bridge.
            if !self.seams.confirm(&mut map, part, self.usual) {
                return Ok((map.finish(), judged));
            }
            start = Some(map.finish());
        }
    }

    /// Stores the map's evidence for each closure in `asked`.
    fn weigh(&mut self, asked: &[usize], judged: Vec<Option<Evidence>>) {
        // Of the accepted closures that the rest contradicts, only the worst third goes now: it may be the cause of the
        // others' errors.
        let mut worst: Vec<f64> = asked
            .iter()
            .zip(&judged)
            .filter(|(closure, _)| self.accepted[**closure])
            .filter_map(|(_, evidence)| evidence.filter(|evidence| evidence.weight() <= CONTRADICTED))
            .map(|evidence| evidence.squared_distance)
            .collect();
        worst.sort_by(|a, b| b.total_cmp(a));
        let limit = worst.get(worst.len().div_ceil(3).saturating_sub(1)).copied().unwrap_or(f64::INFINITY);
        for (&closure, evidence) in asked.iter().zip(judged) {
            // If the rest of the map does not join both ends, the earlier evidence remains.
            let Some(evidence) = evidence else { continue };
            let spared = self.accepted[closure]
                && evidence.weight() <= CONTRADICTED
                && evidence.squared_distance < limit;
            if spared {
                continue;
            }
            let evidence = self.with_bridge(closure, evidence);
            self.ratio[closure] = Some(evidence.weight());
            self.most[closure] = Some(evidence.most);
            self.chance[closure] = Some(evidence.chance);
            self.fits[closure] = evidence.squared_distance <= self.usual;
            self.local[closure] = Some(evidence.local);
        }
    }

    /// The closures within one component that the stored evidence supports.
    fn held(&self, within: &[bool]) -> Vec<bool> {
        let mut next: Vec<bool> = (0..within.len())
            .map(|closure| {
                within[closure]
                    && self.precise(closure)
                    && self.ratio[closure].is_some_and(|ratio| ratio > self.threshold)
            })
            .collect();
        for closure in self.likely(&next) {
            next[closure] = within[closure];
        }
        for closure in (0..within.len()).filter(|&closure| within[closure]) {
            // It was accepted with a hypothesis, and without it nothing joins its ends, so nothing can judge it.
            next[closure] |= self.accepted[closure] && self.ratio[closure].is_none();
        }
        next
    }

    /// The evidence of the map, or that of a bridge if it is stronger and the map does not contradict the closure.
    fn with_bridge(&self, closure: usize, map: Evidence) -> Evidence {
        self.bridged[closure]
            .filter(|bridge| map.weight() > CONTRADICTED && bridge.weight() > map.weight())
            .unwrap_or(map)
    }

    /// Whether the map is certain enough about a closure's ends to distinguish a correct closure from one with a local error.
    fn precise(&self, closure: usize) -> bool {
        let vague = self.local[closure].is_some_and(|local| is_vague(self.random.wrong(local)));
        !self.strict || !vague
    }

    /// Closures with less evidence than a random closure may reach somewhere, but likely at their own position. Their
    /// posterior probability must be high, and higher still if their error is larger than usual. All of them together are
    /// expected to contain less than a third of a wrong one.
    fn likely(&self, next: &[bool]) -> Vec<usize> {
        let odds = self.odds();
        let mut doubts: Vec<(f64, usize)> = (0..next.len())
            .filter(|&closure| !next[closure] && self.precise(closure))
            .filter_map(|closure| Some((1.0 / (1.0 + odds[closure] * self.ratio[closure]?.exp()), closure)))
            .filter(|&(doubt, closure)| doubt < if self.fits[closure] { DOUBT } else { UNUSUAL_DOUBT })
            .collect();
        doubts.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut expected = 0.0;
        doubts
            .into_iter()
            .take_while(|(doubt, _)| {
                expected += doubt;
                expected < 1.0 / COST
            })
            .map(|(_, closure)| closure)
            .collect()
    }

    /// The prior odds of each candidate: those of candidates about which the map could say as much at most, times what the
    /// candidate's score is worth.
    pub(crate) fn odds(&self) -> Vec<f64> {
        let most: &[Option<f64>] = if self.model.without(Ingredient::Prior) { &[] } else { &self.most };
        let prior = Prior::of(&self.ratio, most, self.random.odds());
        let scores = self.scores.ratios(&self.ratio, self.random.odds());
        self.most.iter().zip(scores).map(|(most, score)| prior.odds(*most) * score.exp()).collect()
    }

    /// The members of a hypothesis that the map judged and did not accept; `None` unless these are most of them.
    pub(crate) fn left_out(&self, hypothesis: &Hypothesis) -> Option<Vec<usize>> {
        let is_left_out = |member: &usize| !self.accepted[*member] && self.ratio[*member].is_some();
        let members: Vec<usize> = hypothesis.members.iter().copied().filter(is_left_out).collect();
        (2 * members.len() > hypothesis.members.len()).then_some(members)
    }
}

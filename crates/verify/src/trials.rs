//! Groups of edges that the map contradicts and other groups confirm.
//!
//! Wheels of the wrong size make the same error in every session, far beyond the covariances. Edges from such sessions to
//! others then contradict the map. Groups of false edges contradict it, too. The consequences distinguish the two: a map with
//! the correct edges also agrees with edges between other sessions that the previous map contradicted.

use crate::evidence::Evidence;
use crate::model::Motion;
use crate::rounds::{CONTRADICTED, Rounds};

/// Most maps that are tried in vain between two sets of rounds.
const TRIALS: usize = 4;

impl<G: Motion<DOF>, const DOF: usize> Rounds<'_, G, DOF> {
    /// Accepts the heaviest hypothesis that the map does not hold and a trial confirms. Its errors must be smaller than those
    /// of chance. The trial map with it must closely agree with another hypothesis between other chains, and contradict fewer
    /// closures than it wins. Returns whether there is one.
    pub(crate) fn try_others(&mut self) -> anyhow::Result<bool> {
        let open = self.possible();
        let group = |number: usize| self.model.group(self.hypotheses[number].members[0]);
        let others = |number: usize| -> Vec<usize> {
            open.iter().copied().filter(|&other| group(other) != group(number)).collect()
        };
        let untried = open.iter().filter(|&&number| !self.tried[number]);
        let asked = untried.map(|&number| (number, others(number))).filter(|(_, others)| !others.is_empty());
        let asked: Vec<(usize, Vec<usize>)> = asked.take(TRIALS).collect();
        for (number, others) in asked {
            self.tried[number] = true;
            if self.is_confirmed(number, &others)? {
                for &member in &self.hypotheses[number].members {
                    self.accepted[member] = true;
                }
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Strong hypotheses within components that the map does not hold, and that chance explains no better than odometry
    /// errors do.
    fn possible(&self) -> Vec<usize> {
        let likely = |member: usize| self.chance[member].is_some_and(|ratio| ratio > CONTRADICTED);
        let mut open = self.open();
        open.retain(|&number| {
            let hypothesis = &self.hypotheses[number];
            hypothesis.is_strong() && hypothesis.is_mostly(likely)
        });
        open
    }

    /// Optimises the map with a hypothesis, and checks whether the map agrees with one of the others.
    fn is_confirmed(&self, number: usize, others: &[usize]) -> anyhow::Result<bool> {
        let members = &self.hypotheses[number].members;
        let mut with = self.accepted.clone();
        for &member in members {
            with[member] = true;
        }
        let witnesses: Vec<usize> =
            others.iter().flat_map(|&other| self.hypotheses[other].witnesses()).collect();
        let mut asked: Vec<usize> = (0..with.len()).filter(|&closure| with[closure]).collect();
        asked.extend(&witnesses);
        asked.sort_unstable();
        asked.dedup();
        let bridges = &self.seams.confirmed;
        let mut map = self.drawing.map(self.model, &self.random, &with, bridges, self.poses.as_deref())?;
        map.enough = self.threshold;
        let judged = map.judge(&self.partners, &asked, &witnesses);
        map.finish();
        let contradicted = |(closure, evidence): &(&usize, &Option<Evidence>)| {
            with[**closure] && evidence.is_some_and(|evidence| evidence.weight() <= CONTRADICTED)
        };
        let lost = asked.iter().zip(&judged).filter(contradicted).count();
        let close = |closure: usize| {
            let evidence = judged[asked.binary_search(&closure).ok()?]?;
            (evidence.squared_distance <= self.usual).then(|| evidence.weight())
        };
        Ok(lost < members.len() && others.iter().any(|&other| self.agrees(&self.hypotheses[other], close)))
    }
}

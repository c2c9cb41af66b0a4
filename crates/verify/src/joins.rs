//! Joining components of the graph by hypotheses.

use std::collections::BTreeSet;

use crate::ingredients::Ingredient;
use crate::islands::Hypothesis;
use crate::lone::DOUBTFUL;
use crate::model::Motion;
use crate::rounds::{CONTRADICTED, Rounds};

/// What becomes of a hypothesis that could join two components.
enum Turn {
    Joins,
    /// It may join them later, and nothing of less evidence takes its place meanwhile.
    Waits,
    Refused,
}

impl<G: Motion<DOF>, const DOF: usize> Rounds<'_, G, DOF> {
    /// Joins components by the hypotheses of most evidence, each component at most once a round, so that the next round judges the other
    /// hypotheses by the larger map. Between rivals only a user can choose. Lone ones wait until rounds have `settled`, since only a
    /// map shows whether they are doubtful. Returns whether it joined any.
    pub(crate) fn join(&mut self, next: &mut [bool], settled: bool) -> bool {
        let part = self.parts.clone().into_labeling();
        let mut busy = vec![false; part.len()];
        let mut waiting = BTreeSet::new();
        for hypothesis in self.hypotheses.iter().filter(|hypothesis| hypothesis.is_strong()) {
            let span = self.model.span(hypothesis.members[0]);
            let (a, b) = (part[span.a], part[span.b]);
            let between = (a.min(b), a.max(b));
            if a == b || busy[a] || busy[b] || waiting.contains(&between) {
                continue;
            }
            match self.turn(hypothesis, settled) {
                Turn::Refused => continue,
                Turn::Waits => {
                    waiting.insert(between);
                    continue;
                }
                Turn::Joins => {}
            }
            (busy[a], busy[b]) = (true, true);
            self.parts.union(span.a, span.b);
            // If a bridge between the sessions contradicts some members, leave those out: the map may confirm the bridge.
            let whole = hypothesis.contradicted(&self.begun);
            for &member in &hypothesis.members {
                next[member] = whole || self.begun[member].is_none_or(|begun| begun.weight() > CONTRADICTED);
            }
        }
        busy.contains(&true)
    }

    fn turn(&self, hypothesis: &Hypothesis, settled: bool) -> Turn {
        let is_preferred = self.preferred.is_some_and(|members| members == hypothesis.members);
        if is_preferred || self.model.without(Ingredient::Rivals) {
            Turn::Joins
        } else if self.has_rival(hypothesis) {
            Turn::Refused
        } else if !self.is_lone(hypothesis) {
            Turn::Joins
        } else if !settled {
            Turn::Waits
        } else if self.share_of_correct(hypothesis) < DOUBTFUL {
            Turn::Refused
        } else {
            Turn::Joins
        }
    }
}

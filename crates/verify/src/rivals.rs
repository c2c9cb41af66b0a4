//! Rivals: other ways to join two chains, with evidence comparable to that of the accepted edges.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::islands::Hypothesis;
use crate::judge::Judged;
use crate::model::{Model, Motion};

/// Smallest evidence of a rival, as a share of that of the accepted edges between the same chains.
pub(crate) const COMPARABLE: f64 = 0.5;

/// Another way to join two chains.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Rival {
    /// Its number, as in the findings.
    pub hypothesis: usize,
    /// How many landmark edges it has.
    pub edges: usize,
    /// Its evidence, nats.
    pub evidence: f64,
    /// The evidence of the accepted edges between the same chains, nats.
    pub accepted: f64,
}

/// The rivals of the map, in the order of their numbers.
pub(crate) fn rivals<G: Motion<DOF>, const DOF: usize>(model: &Model<G, DOF>, judged: &Judged) -> Vec<Rival> {
    let group = |hypothesis: &Hypothesis| model.closures[hypothesis.members[0]].group;
    let mut held = BTreeMap::new();
    for hypothesis in judged.hypotheses.iter().filter(|hypothesis| judged.has_member_of(hypothesis)) {
        *held.entry(group(hypothesis)).or_insert(0.0) += hypothesis.evidence;
    }
    (1..)
        .zip(judged.others())
        .filter(|(_, other)| !model.same_chain(other.members[0]))
        .filter_map(|(hypothesis, other)| {
            let accepted = *held.get(&group(other))?;
            let evidence = other.evidence;
            let edges = other.members.len();
            (evidence >= COMPARABLE * accepted).then_some(Rival { hypothesis, edges, evidence, accepted })
        })
        .collect()
}

//! Judges a graph: takes evidence to decisions on all closures.

use petgraph::unionfind::UnionFind;
use posecut_graph::PoseGraph;

use crate::breaks::breaks;
use crate::bridges::{Bridge, Seams, bridged, bridges};
use crate::cut::Tie;
use crate::evidence::chi_square_quantile;
use crate::factors::Factors;
use crate::first_pass::FirstPass;
use crate::ingredients::Ingredient;
use crate::islands::Hypothesis;
use crate::map::Drawing;
use crate::model::{Model, Motion};
use crate::partners::Partners;
use crate::rounds::Rounds;
use crate::scores::Scores;

/// The normal quantile of 99 %, the share of correct closures whose error counts as usual.
const USUAL: f64 = 2.326;

/// The results of judging a graph.
pub(crate) struct Judged {
    pub(crate) accepted: Vec<bool>,
    /// Log-likelihood ratio of each closure in the last round, where there is one.
    pub(crate) ratio: Vec<Option<f64>>,
    /// Prior odds that each closure is correct.
    pub(crate) odds: Vec<f64>,
    /// Odds of a local error of each closure against a correct closure.
    pub(crate) local: Vec<f64>,
    /// The probability that its group is correct, for each closure of a group that nothing but itself speaks for.
    pub(crate) credibility: Vec<Option<f64>>,
    pub(crate) factors: Factors,
    pub(crate) rounds: usize,
    pub(crate) hypotheses: Vec<Hypothesis>,
    /// Bound on the excess of the multicut's cost over the minimum, as a share of it.
    pub(crate) cut_gap: f64,
    /// Evidence of the pairs compared.
    pub(crate) ties: Vec<Tie>,
    /// How many connections between components the closures could make, and how many the accepted ones make.
    pub(crate) joinable: usize,
    pub(crate) joined: usize,
    /// Indices of broken odometry edges in the graph.
    pub(crate) breaks: Vec<usize>,
}

impl Judged {
    /// Strong hypotheses of which the map holds no member, the heaviest first: numbers 1, 2 and so on.
    pub(crate) fn others(&self) -> impl Iterator<Item = &Hypothesis> {
        self.hypotheses.iter().filter(|hypothesis| hypothesis.is_strong() && !self.has_member_of(hypothesis))
    }

    /// Whether the map holds any member of it.
    pub(crate) fn has_member_of(&self, hypothesis: &Hypothesis) -> bool {
        hypothesis.members.iter().any(|&member| self.accepted[member])
    }
}

/// Prior knowledge about a graph: factors, and the indices of the edges to start from, in ascending order.
pub(crate) struct Known {
    pub(crate) factors: Factors,
    pub(crate) accepted: Vec<usize>,
}

/// Judges all closures. The preferred hypothesis, given by its members, joins two components before heavier ones. Known
/// factors are not estimated again, and the map starts from the known accepted closures.
pub(crate) fn judge<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    model: &Model<G, DOF>,
    preferred: Option<&[usize]>,
    known: Option<Known>,
) -> anyhow::Result<Judged> {
    let partners = Partners::of(model);
    let (factors, begun_with) = match known {
        Some(Known { factors, accepted }) => (factors, accepted),
        None => (Factors::of(model, &partners), Vec::new()),
    };
    let known: Vec<bool> = model
        .closures
        .iter()
        .map(|closure| begun_with.binary_search(&closure.candidate.edge).is_ok())
        .collect();
    let first = FirstPass::of(model, &partners, &factors);
    let [within, between] = if model.without(Ingredient::Bridges) {
        [Vec::new(), Vec::new()]
    } else {
        bridges(graph, &model.chains)
    };
    let FirstPass { ties, cut_gap, threshold, ratio, mut accepted, mut hypotheses } = first;
    accepted.iter_mut().zip(&known).for_each(|(accepted, &known)| *accepted |= known);
    let begun = bridged(between.iter(), model, &factors.loops);
    // A hypothesis that contradicts the usual motion from one session to the next joins them only if no other one does.
    hypotheses.sort_by_key(|hypothesis| hypothesis.contradicted(&begun));
    if let Some(preferred) = preferred {
        hypotheses.sort_by_key(|hypothesis| hypothesis.members != preferred);
    }
    let count = model.closures.len();
    let mut rounds = Rounds {
        bridged: bridged(within.iter().chain(&between), model, &factors.loops),
        begun,
        seams: Seams { open: between, confirmed: Vec::new() },
        model,
        scores: Scores::of(graph, model),
        partners,
        drawing: Drawing::of(graph, model)?,
        random: factors.random.clone(),
        threshold,
        tried: vec![false; hypotheses.len()],
        hypotheses,
        preferred,
        parts: joined(model, |closure| known[closure]).0,
        accepted,
        ratio,
        fits: vec![false; count],
        chance: vec![None; count],
        local: vec![None; count],
        strict: false,
        most: vec![None; count],
        usual: chi_square_quantile(DOF, USUAL),
        poses: None,
    };
    let (number, breaks) = settle(graph, &mut rounds, &within)?;
    let odds = rounds.odds();
    let credibility = rounds.credibility();
    let Rounds { accepted, ratio, local, hypotheses, random, .. } = rounds;
    let local = local.iter().map(|ratio| ratio.map_or(0.0, |ratio| random.wrong(ratio))).collect();
    let joinable = joined(model, |_| true).1;
    let joined = joined(model, |closure| accepted[closure]).1;
    Ok(Judged {
        accepted,
        ratio,
        odds,
        local,
        credibility,
        factors,
        rounds: number,
        hypotheses,
        cut_gap,
        ties,
        joinable,
        breaks,
        joined,
    })
}

/// Runs rounds until nothing changes, then looks for broken odometry, and tries hypotheses that the map contradicts. Returns
/// the number of rounds, and the indices of broken odometry edges.
fn settle<G: Motion<DOF>, const DOF: usize>(
    graph: &PoseGraph,
    rounds: &mut Rounds<'_, G, DOF>,
    within: &[Bridge<G, DOF>],
) -> anyhow::Result<(usize, Vec<usize>)> {
    let broken = |rounds: &Rounds<'_, G, DOF>| {
        if rounds.model.without(Ingredient::Breaks) { Vec::new() } else { breaks(graph, rounds) }
    };
    let mut number = rounds.all(within)?;
    let mut found = broken(rounds);
    // If odometry is broken, the caller judges everything again: a hypothesis contradicted now may then agree with the map.
    if found.is_empty() && !rounds.model.without(Ingredient::Trials) {
        while rounds.try_others()? {
            number += rounds.all(within)?;
        }
        found = broken(rounds);
    }
    Ok((number, found))
}

/// The components that some closures make of the chains, and how many of these closures join two components.
pub(crate) fn joined<G: Motion<DOF>, const DOF: usize>(
    model: &Model<G, DOF>,
    is_among: impl Fn(usize) -> bool,
) -> (UnionFind<usize>, usize) {
    let mut parts = UnionFind::new(model.chains.chains.len());
    let among =
        (0..model.closures.len()).filter(|&closure| is_among(closure)).map(|closure| model.span(closure));
    let joins = among.filter(|span| parts.union(span.a, span.b)).count();
    (parts, joins)
}

//! From evidence to decisions.

use petgraph::unionfind::UnionFind;
use posecut_graph::PoseGraph;
use rayon::prelude::*;

use crate::breaks::breaks;
use crate::bridges::{Seams, bridged, bridges};
use crate::calibration::{Calibration, Factors};
use crate::cut::{COST, Tie, cut, tied};
use crate::evidence::chi_square_quantile;
use crate::ingredients::Ingredient;
use crate::islands::{Hypothesis, islands, support};
use crate::map::Drawing;
use crate::model::{Model, Motion};
use crate::partners::Partners;
use crate::rounds::Rounds;

/// The normal quantile of 99 %, the share of correct closures whose error is usual.
const USUAL: f64 = 2.326;

/// What was found.
pub(crate) struct Judged {
    pub(crate) accepted: Vec<bool>,
    /// Log-likelihood ratio of each closure in the last round, where there is one.
    pub(crate) ratio: Vec<Option<f64>>,
    /// Prior odds that each is correct, where there is one.
    pub(crate) odds: Vec<f64>,
    /// How likely a local error of each closure is, over a correct closure.
    pub(crate) local: Vec<f64>,
    pub(crate) factors: Factors,
    pub(crate) rounds: usize,
    pub(crate) hypotheses: Vec<Hypothesis>,
    /// By how much the cost of the multicut may exceed the minimum, as a share of it.
    pub(crate) cut_gap: f64,
    /// Evidence of the pairs compared.
    pub(crate) ties: Vec<Tie>,
    /// Parts of the graph that closures could join, and those that they do.
    pub(crate) joinable: usize,
    pub(crate) joined: usize,
    /// Places among the graph's edges of odometry that is broken.
    pub(crate) breaks: Vec<usize>,
}

impl Judged {
    /// Hypotheses that the map has nothing of, the heaviest first: number 1, 2 and so on.
    pub(crate) fn others(&self) -> impl Iterator<Item = &Hypothesis> {
        self.hypotheses.iter().filter(|hypothesis| hypothesis.is_strong() && !self.holds(hypothesis))
    }

    /// Whether the map has any of it.
    pub(crate) fn holds(&self, hypothesis: &Hypothesis) -> bool {
        hypothesis.members.iter().any(|&member| self.accepted[member])
    }
}

/// What is known of a graph before it is judged: factors, and the indices of the edges to start from, in ascending order.
pub(crate) struct Known {
    pub(crate) factors: Factors,
    pub(crate) accepted: Vec<usize>,
}

/// Judges all closures. Of the hypotheses that join two parts, the preferred one, named by its members, goes before heavier ones.
/// Factors that are known are not estimated again, and the map starts from closures known to be accepted.
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
    let Factors { loops: calibration, random } = factors.clone();
    let ties = ties(model, &partners, &calibration);
    let count = model.closures.len();
    let ratio: Vec<Option<f64>> =
        (0..count).map(|closure| Some(calibration.evidence(&model.single(closure)?)?.distant())).collect();
    let threshold = (COST * count as f64 * (1.0 - calibration.correct)).max(1.0).ln();
    let chains = model.chains.chains.len();
    let anchored: Vec<Option<(usize, f64)>> = ratio
        .iter()
        .enumerate()
        .map(|(closure, ratio)| ratio.map(|ratio| (model.span(closure).a, ratio)))
        .collect();
    let together = if model.without(Ingredient::Multicut) { tied } else { cut };
    let clusters = together(count, chains, &ties, &anchored, calibration.correct);
    let support = support(&clusters, &ties, &anchored);
    // Islands that hang together closely are as many chances to agree by chance, and no more.
    let close = islands(&clusters, &ties, &support, threshold, threshold);
    let trials = close.count(&support, threshold) as f64;
    let loose = (COST * trials * (1.0 - calibration.correct)).max(1.0).ln();
    let islands = islands(&clusters, &ties, &support, threshold, loose);
    let best = islands.best(&ratio);
    let known = |closure: usize| begun_with.binary_search(&model.closures[closure].candidate.edge).is_ok();
    // What an island says of the trajectory shares its odometry: it counts once, as its best member does.
    let anchored_well = |closure: usize| {
        anchored[closure]
            .is_some_and(|(anchor, _)| clusters.labels[closure] == clusters.labels[count + anchor])
            && support[closure] > threshold
            && best[islands.forest.find(closure)] > loose
    };
    let accepted = (0..count).map(|closure| known(closure) || anchored_well(closure)).collect();
    let mut hypotheses = islands.hypotheses(threshold);
    let mut parts = UnionFind::new(chains);
    for span in (0..count).filter(|&closure| known(closure)).map(|closure| model.span(closure)) {
        parts.union(span.a, span.b);
    }
    let drawing = Drawing::of(graph, model)?;
    let [within, between] = if model.without(Ingredient::Bridges) {
        [Vec::new(), Vec::new()]
    } else {
        bridges(graph, &model.chains)
    };
    let begun = bridged(between.iter(), model, &calibration);
    // What the usual motion from one session to the next contradicts joins them only where nothing else does.
    hypotheses.sort_by_key(|hypothesis| hypothesis.contradicted(&begun));
    if let Some(preferred) = preferred {
        hypotheses.sort_by_key(|hypothesis| hypothesis.members != preferred);
    }
    let mut rounds = Rounds {
        bridged: bridged(within.iter().chain(&between), model, &calibration),
        begun,
        seams: Seams { open: between, confirmed: Vec::new() },
        model,
        partners,
        drawing,
        random,
        threshold,
        tried: vec![false; hypotheses.len()],
        hypotheses,
        parts,
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
    let mut number = rounds.all(&within)?;
    let broken = |rounds: &Rounds<'_, G, DOF>| {
        if model.without(Ingredient::Breaks) { Vec::new() } else { breaks(graph, rounds) }
    };
    let mut breaks = broken(&rounds);
    // Where odometry is broken everything is judged again, and what it contradicts now may agree with the map.
    if breaks.is_empty() && !model.without(Ingredient::Trials) {
        while rounds.try_others()? {
            number += rounds.all(&within)?;
        }
        breaks = broken(&rounds);
    }
    let mut all = UnionFind::<usize>::new(chains);
    let joinable = model.spans.iter().filter(|span| all.union(span.a, span.b)).count();
    let mut held = UnionFind::<usize>::new(chains);
    let spans = (0..count).filter(|&closure| rounds.accepted[closure]).map(|closure| model.span(closure));
    let joined = spans.filter(|span| held.union(span.a, span.b)).count();
    let prior = rounds.prior();
    let odds = rounds.most.iter().map(|most| prior.odds(*most)).collect();
    let Rounds { accepted, ratio, local, hypotheses, random, .. } = rounds;
    let local = local.iter().map(|ratio| ratio.map_or(0.0, |ratio| random.wrong(ratio))).collect();
    let cut_gap = clusters.gap;
    Ok(Judged {
        accepted,
        ratio,
        odds,
        local,
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

/// The evidence of each pair of partners.
fn ties<G: Motion<DOF>, const DOF: usize>(
    model: &Model<G, DOF>,
    partners: &Partners,
    calibration: &Calibration,
) -> Vec<Tie> {
    let mut pairs: Vec<(usize, usize)> = (0..model.closures.len())
        .flat_map(|one| partners.all(one).map(move |other| (one.min(other), one.max(other))))
        .collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs
        .into_par_iter()
        .filter_map(|(one, other)| {
            let evidence = calibration.evidence(&model.pair(one, other))?;
            Some(Tie { one, other, ratio: evidence.weight() })
        })
        .collect()
}

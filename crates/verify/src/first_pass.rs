//! The first pass: verdicts by the multicut alone, before any map is optimised.

use rayon::prelude::*;

use crate::calibration::Calibration;
use crate::cut::{COST, Tie, cut, tied};
use crate::ingredients::Ingredient;
use crate::islands::{Hypothesis, islands, support};
use crate::model::{Model, Motion};
use crate::partners::Partners;

/// Clusters of closures that agree with each other, and the conclusions from them alone.
pub(crate) struct FirstPass {
    /// Evidence of the pairs compared.
    pub(crate) ties: Vec<Tie>,
    /// Bound on the excess of the multicut's cost over the minimum, as a share of it.
    pub(crate) cut_gap: f64,
    /// Evidence above which one closure is unlikely to agree by chance, nats.
    pub(crate) threshold: f64,
    /// Log-likelihood ratio of each closure against the odometry of its own chain, where there is one.
    pub(crate) ratio: Vec<Option<f64>>,
    /// Whether each closure is in one cluster with its odometry, with enough evidence.
    pub(crate) accepted: Vec<bool>,
    /// Groups that agree with each other, the heaviest first.
    pub(crate) hypotheses: Vec<Hypothesis>,
}

impl FirstPass {
    /// Compares all partners and cuts.
    pub(crate) fn of<G: Motion<DOF>, const DOF: usize>(
        model: &Model<G, DOF>,
        partners: &Partners,
        calibration: &Calibration,
    ) -> Self {
        let ties = ties(model, partners, calibration);
        let count = model.closures.len();
        let ratio: Vec<Option<f64>> = (0..count)
            .map(|closure| Some(calibration.evidence(&model.single(closure)?)?.distant()))
            .collect();
        let bound = |trials: f64| (COST * trials * (1.0 - calibration.correct)).max(1.0).ln();
        let threshold = bound(count as f64);
        let chains = model.chains.chains.len();
        let anchored: Vec<Option<(usize, f64)>> = ratio
            .iter()
            .enumerate()
            .map(|(closure, ratio)| ratio.map(|ratio| (model.span(closure).a, ratio)))
            .collect();
        let together = if model.without(Ingredient::Multicut) { tied } else { cut };
        let clusters = together(count, chains, &ties, &anchored, calibration.correct);
        let support = support(&clusters, &ties, &anchored);
        // A tightly connected island has only one chance to agree by chance, so the bound counts islands instead of closures.
        let close = islands(&clusters, &ties, &support, threshold, threshold);
        let loose = bound(close.count(&support, threshold) as f64);
        let islands = islands(&clusters, &ties, &support, threshold, loose);
        let best = islands.best(&ratio);
        // The members of an island share odometry, so their evidence against the chain counts once: that of the best member.
        let anchored_well = |closure: usize| {
            anchored[closure]
                .is_some_and(|(anchor, _)| clusters.labels[closure] == clusters.labels[count + anchor])
                && support[closure] > threshold
                && best[islands.forest.find(closure)] > loose
        };
        let accepted = (0..count).map(anchored_well).collect();
        let hypotheses = islands.hypotheses(threshold);
        Self { accepted, hypotheses, cut_gap: clusters.gap, ties, threshold, ratio }
    }
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
